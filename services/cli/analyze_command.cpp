#include <CLI/CLI.hpp>
#include <filesystem>
#include <iostream>
#include <map>
#include <memory>
#include <string>

#include "base/clock.h"
#include "base/files.h"
#include "base/ids.h"
#include "cli/commands.h"
#include "cli/exit_code.h"
#include "cli/json_arguments.h"
#include "cli/progress_bar.h"
#include "cli/report_table.h"
#include "defect_analysis/pipeline.h"
#include "defect_analysis/report/report_files.h"
#include "scene/cameras_json.h"
#include "scene/ply.h"

namespace drupe {

namespace {

/// What the user wrote after `drupe analyze`.
struct AnalyzeArguments {
  std::string cloud;
  std::string cameras;
  std::string options;
  std::string background_model;
  std::string class_model;
  std::string out;
  int threads = 0;
  std::uint64_t seed = 1;
};

Status LoadCameras(const std::string& file, AnalysisInput& input) {
  if (file.empty()) return Status::Ok();
  DRUPE_ASSIGN_OR_RETURN(const Json json, LoadJsonArgument(file));
  DRUPE_ASSIGN_OR_RETURN(const SparseModel model, ParseCameras(json));
  input.scale_source = model.scale_source;
  for (const View& view : model.views) {
    if (view.cam_from_world) input.camera_centres.push_back(view.cam_from_world->Centre());
  }
  return Status::Ok();
}

Result<AnalysisInput> LoadInput(const AnalyzeArguments& arguments) {
  AnalysisInput input;
  DRUPE_ASSIGN_OR_RETURN(const std::string bytes, ReadFile(arguments.cloud));
  DRUPE_ASSIGN_OR_RETURN(input.cloud, ReadPly(bytes));
  DRUPE_RETURN_IF_ERROR(LoadCameras(arguments.cameras, input));
  if (!arguments.background_model.empty()) {
    DRUPE_ASSIGN_OR_RETURN(input.background_model, LoadModelArgument(arguments.background_model));
  }
  return input;
}

Json TimingsJson(const Stopwatch& watch, const Report& report) {
  return {{"analysis_wall_s", watch.WallSeconds()},
          {"analysis_cpu_s", watch.CpuSeconds()},
          {"peak_mb", ProcessPeakMb()},
          {"stages_s", report.timings_s}};
}

Status Analyze(const AnalyzeArguments& arguments) {
  DRUPE_ASSIGN_OR_RETURN(const Json json, LoadJsonArgument(arguments.options));
  DRUPE_ASSIGN_OR_RETURN(AnalysisOptions options, ParseAnalysisOptions(json));
  if (!arguments.class_model.empty()) {
    DRUPE_ASSIGN_OR_RETURN(options.defects.classes.model, LoadClassModelArgument(arguments.class_model));
  }
  const Stopwatch watch;
  DRUPE_ASSIGN_OR_RETURN(const AnalysisInput input, LoadInput(arguments));
  ProgressBar bar(std::cerr);
  RunContext context;
  context.threads = arguments.threads;
  context.seed = arguments.seed;
  context.progress = [&bar](std::string_view stage, double fraction) { bar.Update(stage, fraction); };
  DRUPE_ASSIGN_OR_RETURN(Report report, RunAnalysis(input, options, context));
  bar.Finish();
  report.id = NewId("rec");
  report.created_at = FormatUtc(Clock::System().NowMs());
  report.quality = {{"dense_points", input.cloud.size()}};
  const std::filesystem::path out = arguments.out;
  std::error_code error;
  std::filesystem::create_directories(out, error);
  if (error) return InvalidArgument("bad_output", "cannot create " + arguments.out + ": " + error.message(), "--out");
  const Json timings = TimingsJson(watch, report);
  using Files = std::map<std::string, std::string>;
  DRUPE_ASSIGN_OR_RETURN(Files files, MakeReportFiles(report, input.cloud, SparseModel(), PhotographSource()));
  files["timings.json"] = DumpJson(timings, 1);
  for (const auto& [name, content] : files) DRUPE_RETURN_IF_ERROR(WriteFileAtomically(out / name, content));
  std::fputs(ReportTable(report).c_str(), stdout);
  std::printf("%zu points in %.2f s (%.2f s of CPU), %.0f MB. Written to %s\n", input.cloud.size(), watch.WallSeconds(),
              watch.CpuSeconds(), ProcessPeakMb(), arguments.out.c_str());
  return Status::Ok();
}

}  // namespace

void AddAnalyzeCommand(CLI::App& app, int& exit_code) {
  auto arguments = std::make_shared<AnalyzeArguments>();
  CLI::App* command = app.add_subcommand("analyze", "Analyse a dense cloud, for instance again with other options");
  command->add_option("CLOUD", arguments->cloud, "dense.ply of `drupe run`, or another coloured binary PLY file")
      ->required();
  command->add_option("--cameras", arguments->cameras,
                      "cameras.json of the same run: whether the cloud is in mm, and where it was seen from");
  command->add_option(
      "--options", arguments->options,
      "Options of the analysis: a JSON file, or JSON such as '{\"contour\": {\"control_points\": 12}}'");
  command->add_option("--background-model", arguments->background_model,
                      "A model of `drupe model train`, in place of the one built in");
  command->add_option("--class-model", arguments->class_model,
                      "A model of `drupe classifier train`, in place of the rules by which defects are classed");
  command
      ->add_option("--out", arguments->out,
                   "Directory for report.json report.csv observations.json defects.ply timings.json")
      ->required();
  command->add_option("--threads", arguments->threads, "Threads; 0: one a core. The result does not depend on it")
      ->check(CLI::Range(0, 1024));
  command->add_option("--seed", arguments->seed, "Seed of the random choices");
  command->callback([arguments, &exit_code] { exit_code = CommandExitCode("drupe analyze", Analyze(*arguments)); });
}

}  // namespace drupe
