#include <CLI/CLI.hpp>
#include <cstdio>
#include <memory>
#include <string>
#include <vector>

#include "base/clock.h"
#include "base/files.h"
#include "cli/bench/bench.h"
#include "cli/bench/defect_scores.h"
#include "cli/bench/text_table.h"
#include "cli/bench/truth_set.h"
#include "cli/json_arguments.h"
#include "defect_analysis/pipeline.h"
#include "scene/cameras_json.h"
#include "scene/ply.h"
#include "scene/random_fruit.h"

namespace drupe {

namespace {

struct DefectsArguments {
  std::vector<std::string> sets;
  std::string results;
  std::string options;
  int fruits = 0;
  std::uint64_t seed = 1;
  double spacing_mm = RandomFruitOptions{}.spacing_mm;
  bool notes = false;
};

void TakeCameras(const SparseModel& model, AnalysisInput& input) {
  input.scale_source = model.scale_source;
  input.scale_relative_sigma = model.scale_relative_sigma;
  for (const View& view : model.views) {
    if (view.cam_from_world) input.camera_centres.push_back(view.cam_from_world->Centre());
  }
}

/// The cloud that `drupe run` left in a directory.
Result<AnalysisInput> LoadResult(const std::string& directory) {
  AnalysisInput input;
  DRUPE_ASSIGN_OR_RETURN(const std::string ply, ReadFile(directory + "/dense.ply"));
  DRUPE_ASSIGN_OR_RETURN(input.cloud, ReadPly(ply));
  DRUPE_ASSIGN_OR_RETURN(const Json cameras, LoadJsonArgument(directory + "/cameras.json"));
  DRUPE_ASSIGN_OR_RETURN(const SparseModel model, ParseCameras(cameras));
  TakeCameras(model, input);
  return input;
}

Result<AnalysisInput> Reconstruct(const TruthSet& set) {
  DRUPE_ASSIGN_OR_RETURN(ReconstructionOutput output, RunReconstruction(set.input, {}, {}));
  AnalysisInput input;
  input.cloud = std::move(output.cloud);
  TakeCameras(output.model, input);
  return input;
}

Status ScoreSet(const std::string& directory, const DefectsArguments& arguments, const AnalysisOptions& options,
                DefectScores& scores) {
  DRUPE_ASSIGN_OR_RETURN(const TruthSet set, LoadTruthSet(directory));
  DRUPE_ASSIGN_OR_RETURN(const std::vector<FruitTruth> truths, ParseFruitTruths(set.truth));
  DRUPE_ASSIGN_OR_RETURN(const AnalysisInput input,
                         arguments.results.empty() ? Reconstruct(set) : LoadResult(arguments.results + "/" + set.name));
  DRUPE_ASSIGN_OR_RETURN(const Report report, RunAnalysis(input, options, {}));
  scores.Add(set.name, truths, report.fruits);
  return Status::Ok();
}

Status ScoreRandomFruit(std::uint64_t seed, const DefectsArguments& arguments, const AnalysisOptions& options,
                        DefectScores& scores) {
  RandomFruit fruit = MakeRandomFruit(seed, {.spacing_mm = arguments.spacing_mm});
  AnalysisInput input;
  input.cloud = std::move(fruit.cloud);
  input.scale_source = ScaleSource::kBoard;
  DRUPE_ASSIGN_OR_RETURN(const Report report, RunAnalysis(input, options, {}));
  scores.Add("seed " + std::to_string(seed), {fruit.truth}, report.fruits);
  return Status::Ok();
}

void Print(const char* title, const DefectScores& scores, bool notes) {
  std::printf("%s\n%s", title, scores.Text().c_str());
  for (std::size_t i = 0; notes && i < scores.notes().size(); ++i) std::printf("  %s\n", scores.notes()[i].c_str());
  std::fflush(stdout);
}

Status Run(const DefectsArguments& arguments) {
  DRUPE_ASSIGN_OR_RETURN(const Json json, LoadJsonArgument(arguments.options));
  DRUPE_ASSIGN_OR_RETURN(const AnalysisOptions options, ParseAnalysisOptions(json));
  if (arguments.sets.empty() && arguments.fruits == 0) {
    return InvalidArgument("nothing_to_do", "name set directories, or a number of random fruits with --fruits");
  }
  const Stopwatch watch;
  if (!arguments.sets.empty()) {
    DefectScores scores;
    for (const std::string& set : arguments.sets) DRUPE_RETURN_IF_ERROR(ScoreSet(set, arguments, options, scores));
    Print("Sets", scores, arguments.notes);
  }
  if (arguments.fruits > 0) {
    DefectScores scores;
    for (int k = 0; k < arguments.fruits; ++k) {
      DRUPE_RETURN_IF_ERROR(
          ScoreRandomFruit(arguments.seed + static_cast<std::uint64_t>(k), arguments, options, scores));
    }
    Print("Random fruits", scores, arguments.notes);
  }
  std::printf("CPU %s s\n", FixedText(watch.CpuSeconds(), 1).c_str());
  return Status::Ok();
}

}  // namespace

void AddDefectsBench(CLI::App& bench, int& exit_code) {
  auto arguments = std::make_shared<DefectsArguments>();
  CLI::App* command = bench.add_subcommand(
      "defects",
      "Defects, classes, grades, areas and their uncertainties against the truth, on rendered sets and on made-up\n"
      "fruits of random shape, colour and defects.\n"
      "Example: drupe bench defects --fruits 100 --seed 1 --notes\n"
      "         drupe bench defects --results OUT data/plum-s data/plum-v2   (OUT/plum-s is a drupe run's --out)");
  command->add_option("SET_DIR", arguments->sets,
                      "Sets with truth.json; they are reconstructed first unless --results is given");
  command->add_option("--results", arguments->results,
                      "Directory with one folder a set, each the --out of a drupe run, whose clouds are analysed");
  command->add_option("--fruits", arguments->fruits, "Number of made-up fruits")->check(CLI::Range(0, 100000));
  command->add_option("--seed", arguments->seed, "Of the first made-up fruit; the next ones count up");
  command->add_option("--spacing", arguments->spacing_mm, "mm between the points of a made-up fruit")
      ->check(CLI::Range(0.02, 0.5));
  command->add_option("--options", arguments->options, "Options of the analysis: a JSON file, or JSON");
  command->add_flag("--notes", arguments->notes, "Name every miss, false defect, wrong class and wrong area");
  command->callback([arguments, &exit_code] { exit_code = BenchExitCode(Run(*arguments)); });
}

}  // namespace drupe
