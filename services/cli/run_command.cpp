#include <CLI/CLI.hpp>
#include <filesystem>
#include <iostream>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "base/clock.h"
#include "base/digest.h"
#include "base/files.h"
#include "base/ids.h"
#include "base/json.h"
#include "base/version.h"
#include "cli/commands.h"
#include "cli/exit_code.h"
#include "cli/json_arguments.h"
#include "cli/progress_bar.h"
#include "cli/report_table.h"
#include "cli/source_images.h"
#include "defect_analysis/pipeline.h"
#include "defect_analysis/report/report_files.h"
#include "reconstruction/pipeline.h"
#include "reconstruction/similarity/vocabulary.h"

namespace drupe {

namespace {

/// What the user wrote after `drupe run`.
struct RunArguments {
  std::string images;
  std::string calibration;
  std::string board;
  std::string out;
  std::string options;
  std::string analysis_options;
  std::string background_model;
  std::string class_model;
  int threads = 0;
  std::uint64_t seed = 1;
  bool no_analysis = false;
  bool mesh = false;
};

Result<ReconstructionInput> LoadInput(const RunArguments& arguments) {
  ReconstructionInput input;
  DRUPE_ASSIGN_OR_RETURN(input.images, LoadSourceImages(arguments.images, input.limits));
  if (!arguments.calibration.empty()) {
    DRUPE_ASSIGN_OR_RETURN(const Json json, LoadJsonArgument(arguments.calibration));
    DRUPE_ASSIGN_OR_RETURN(input.calibration, ParseCalibration(json));
  }
  DRUPE_ASSIGN_OR_RETURN(input.board, LoadBoardArgument(arguments.board));
  input.read_vocabulary = [](const std::string& path) { return ReadFile(path, MaxVocabularyBytes()); };
  return input;
}

Provenance MakeProvenance(const ReconstructionInput& input, const Json& options) {
  Provenance provenance;
  for (const SourceImage& image : input.images) {
    const Result<std::string> bytes = image.read();
    provenance.image_sha256.push_back(bytes.ok() ? Sha256Hex(*bytes) : "");
  }
  provenance.calibration = input.calibration ? ToJson(*input.calibration) : Json(nullptr);
  provenance.options = options;
  provenance.build = kVersion;
  return provenance;
}

Json StageSeconds(const Timings& timings) {
  Json seconds = Json::object();
  for (const StageTiming& stage : timings.stages) seconds[stage.name] = stage.wall_s;
  return seconds;
}

/// Everything that the arguments name, read and checked before any work begins.
struct RunRequest {
  ReconstructionInput input;
  ReconstructionOptions options;
  AnalysisOptions analysis_options;
  std::optional<ColourModel> background_model;
};

Result<RunRequest> LoadRequest(const RunArguments& arguments) {
  RunRequest request;
  DRUPE_ASSIGN_OR_RETURN(request.input, LoadInput(arguments));
  DRUPE_ASSIGN_OR_RETURN(const Json options, LoadJsonArgument(arguments.options));
  DRUPE_ASSIGN_OR_RETURN(request.options, ParseReconstructionOptions(options));
  request.options.dense.mesh = request.options.dense.mesh || arguments.mesh;
  DRUPE_ASSIGN_OR_RETURN(const Json analysis_options, LoadJsonArgument(arguments.analysis_options));
  DRUPE_ASSIGN_OR_RETURN(request.analysis_options, ParseAnalysisOptions(analysis_options));
  if (!arguments.background_model.empty()) {
    DRUPE_ASSIGN_OR_RETURN(request.background_model, LoadModelArgument(arguments.background_model));
  }
  if (!arguments.class_model.empty()) {
    DRUPE_ASSIGN_OR_RETURN(request.analysis_options.defects.classes.model,
                           LoadClassModelArgument(arguments.class_model));
  }
  std::error_code error;
  std::filesystem::create_directories(arguments.out, error);
  if (error) return InvalidArgument("bad_output", "cannot create " + arguments.out + ": " + error.message(), "--out");
  return request;
}

/// Analyses the cloud, times it and completes the report with what only the caller knows.
Result<Report> Analyse(const RunRequest& request, ReconstructionOutput& output, const RunContext& context) {
  AnalysisInput analysis;
  analysis.cloud = output.cloud;
  analysis.scale_source = output.model.scale_source;
  analysis.scale_relative_sigma = output.model.scale_relative_sigma;
  analysis.board = request.input.board;
  analysis.background_model = request.background_model;
  for (const View& view : output.model.views) {
    if (view.cam_from_world) analysis.camera_centres.push_back(view.cam_from_world->Centre());
  }
  const Stopwatch watch;
  DRUPE_ASSIGN_OR_RETURN(Report report, RunAnalysis(analysis, request.analysis_options, context));
  output.timings.Add("analysis", watch);
  output.timings.analysis_cpu_s = watch.CpuSeconds();
  output.timings.analysis_wall_s = watch.WallSeconds();
  report.created_at = FormatUtc(Clock::System().NowMs());
  report.quality = QualityJson(output);
  report.provenance = MakeProvenance(
      request.input, {{"reconstruction", ToJson(request.options)}, {"analysis", ToJson(request.analysis_options)}});
  report.timings_s = StageSeconds(output.timings);
  report.id = NewId("rec");
  return report;
}

/// The pictures by their place in the model.
PhotographSource PhotographsOf(const ReconstructionInput& input, const SparseModel& model) {
  return [&input, &model](std::size_t view) -> Result<std::string> {
    for (const SourceImage& image : input.images) {
      if (image.name == model.views[view].image) return image.read();
    }
    return NotFound("image_not_found", "there is no picture " + model.views[view].image);
  };
}

Status WriteResults(const std::string& directory, const ReconstructionInput& input, const ReconstructionOutput& output,
                    const std::optional<Report>& report) {
  using Files = std::map<std::string, std::string>;
  DRUPE_ASSIGN_OR_RETURN(Files files, MakeArtifacts(output));
  if (report) {
    DRUPE_ASSIGN_OR_RETURN(Files more,
                           MakeReportFiles(*report, output.cloud, output.model, PhotographsOf(input, output.model)));
    files.merge(std::move(more));
  }
  for (const auto& [name, content] : files) {
    DRUPE_RETURN_IF_ERROR(WriteFileAtomically(std::filesystem::path(directory) / name, content));
  }
  return Status::Ok();
}

void PrintSummary(const ReconstructionOutput& output, std::size_t image_count, const std::optional<Report>& report) {
  std::printf("Registered %d of %zu pictures; %zu sparse and %zu dense points; %.1f s, %.0f MB.\n",
              output.model.RegisteredCount(), image_count, output.model.tracks.size(), output.cloud.size(),
              output.timings.total_wall_s, output.timings.peak_mb);
  for (const RefusedImage& refused : output.refused) {
    std::printf("Left out %s: %s\n", refused.name.c_str(), refused.status.message().c_str());
  }
  for (const View& view : output.model.views) {
    if (!view.cam_from_world) std::printf("Not registered %s: %s\n", view.image.c_str(), view.reason.c_str());
  }
  if (report) std::fputs(ReportTable(*report).c_str(), stdout);
}

Status Run(const RunArguments& arguments) {
  const Stopwatch total;
  DRUPE_ASSIGN_OR_RETURN(const RunRequest request, LoadRequest(arguments));
  ProgressBar bar(std::cerr);
  RunContext context;
  context.threads = arguments.threads;
  context.seed = arguments.seed;
  context.progress = [&bar](std::string_view stage, double fraction) { bar.Update(stage, fraction); };
  DRUPE_ASSIGN_OR_RETURN(ReconstructionOutput output, RunReconstruction(request.input, request.options, context));
  std::optional<Report> report;
  if (request.options.run_dense && !arguments.no_analysis) {
    DRUPE_ASSIGN_OR_RETURN(report, Analyse(request, output, context));
  }
  bar.Finish();
  output.timings.total_wall_s = total.WallSeconds();
  output.timings.peak_mb = ProcessPeakMb();
  DRUPE_RETURN_IF_ERROR(WriteResults(arguments.out, request.input, output, report));
  PrintSummary(output, request.input.images.size(), report);
  std::printf("Written to %s\n", arguments.out.c_str());
  return Status::Ok();
}

}  // namespace

void AddRunCommand(CLI::App& app, int& exit_code) {
  auto arguments = std::make_shared<RunArguments>();
  CLI::App* command = app.add_subcommand("run", "From a directory of turntable pictures to the defect report");
  command
      ->add_option("IMAGES_DIR", arguments->images,
                   "Pictures of one turn (JPEG, PNG or TIFF), in the order of their names")
      ->required();
  command->add_option("--calibration", arguments->calibration,
                      "calibration.json of the camera; without it the focal length is estimated");
  command->add_option("--board", arguments->board,
                      "board.json of the markers on the turntable, or 'default' for the 9 x 9 board that `drupe board` "
                      "prints; without it nothing is in millimetres");
  command
      ->add_option(
          "--out", arguments->out,
          "Directory for cameras.json sparse.ply dense.ply preview.ply colmap.zip model.nvm timings.json, report.json "
          "report.csv observations.json defects.ply contact_sheet.png defect_FRUIT_DEFECT.png, and mesh.ply with "
          "--mesh")
      ->required();
  command->add_option("--options", arguments->options,
                      "Options of the reconstruction: a JSON file, or JSON such as '{\"dense\": {\"level\": 1}}'");
  command->add_option("--analysis-options", arguments->analysis_options, "Options of the defect analysis, likewise");
  command->add_option("--background-model", arguments->background_model,
                      "A model of `drupe model train`, in place of the one built in");
  command->add_option("--class-model", arguments->class_model,
                      "A model of `drupe classifier train`, in place of the rules by which defects are classed");
  command->add_option("--threads", arguments->threads, "Threads; 0: one a core. The result does not depend on it")
      ->check(CLI::Range(0, 1024));
  command->add_option("--seed", arguments->seed, "Seed of the random choices");
  command->add_flag("--mesh", arguments->mesh, "Also a closed surface of triangles, mesh.ply, for volume and viewers");
  command->add_flag("--no-analysis", arguments->no_analysis, "Stop after the dense cloud");
  command->callback([arguments, &exit_code] { exit_code = CommandExitCode("drupe run", Run(*arguments)); });
}

}  // namespace drupe
