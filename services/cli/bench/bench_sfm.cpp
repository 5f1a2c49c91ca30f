#include <CLI/CLI.hpp>
#include <cstdio>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "base/ids.h"
#include "cli/bench/bench.h"
#include "cli/bench/colmap_peer.h"
#include "cli/bench/openmvg_peer.h"
#include "cli/bench/peer_process.h"
#include "cli/bench/set_bench.h"
#include "cli/bench/sfm_run.h"
#include "cli/bench/text_table.h"

namespace drupe {

namespace {

/// What the user wrote after `drupe bench sfm`.
struct SfmArguments {
  SetArguments sets;
  std::string peers = "all";
  bool exhaustive = false;
  bool without_board = false;
};

double StageCpu(const Timings& timings, const std::string& name) {
  double cpu_s = 0;
  for (const StageTiming& stage : timings.stages) cpu_s += stage.name == name ? stage.cpu_s : 0;
  return cpu_s;
}

Result<SfmRun> RunOurs(const TruthSet& set, const SfmArguments& arguments, SparseMethod method) {
  ReconstructionInput input = set.input;
  if (arguments.without_board) input.board.reset();
  ReconstructionOptions options;
  options.run_dense = false;
  options.sparse.method = method;
  DRUPE_ASSIGN_OR_RETURN(const ReconstructionOutput output,
                         RunReconstruction(input, options, arguments.sets.Context()));
  SfmRun run;
  run.method = method == SparseMethod::kClusters ? "Drupe" : "Drupe, without clustering";
  run.features_cpu_s = StageCpu(output.timings, "features");
  run.poses_cpu_s = StageCpu(output.timings, "sparse");
  run.all_cpu_s = output.timings.sparse_cpu_s;
  run.matching_cpu_s = run.all_cpu_s - run.features_cpu_s - run.poses_cpu_s;
  run.wall_s = output.timings.sparse_wall_s;
  run.points = output.model.tracks.size();
  run.views = output.model.views;
  return run;
}

/// A directory for the peer's files that goes with it.
class ScratchDirectory {
 public:
  ScratchDirectory() : path_(std::filesystem::temp_directory_path() / NewId("bench")) {
    std::filesystem::create_directories(path_);
  }
  ~ScratchDirectory() {
    std::error_code ignored;
    std::filesystem::remove_all(path_, ignored);
  }
  ScratchDirectory(const ScratchDirectory&) = delete;
  ScratchDirectory& operator=(const ScratchDirectory&) = delete;
  std::string path() const { return path_.string(); }

 private:
  std::filesystem::path path_;
};

Result<SfmRun> RunColmapIn(const TruthSet& set, bool exhaustive) {
  const ScratchDirectory scratch;
  ColmapPairs pairs;
  pairs.exhaustive = exhaustive;
  return RunColmap(set, pairs, scratch.path());
}

Result<SfmRun> RunOpenMvgIn(const TruthSet& set) {
  const ScratchDirectory scratch;
  return RunOpenMvg(set, scratch.path());
}

Result<std::vector<std::string>> RowOf(const TruthSet& set, const SfmRun& run) {
  DRUPE_ASSIGN_OR_RETURN(const PoseErrors errors, ComparePoses(set, run.views));
  return std::vector<std::string>{run.method,
                                  FixedText(run.features_cpu_s, 1),
                                  FixedText(run.matching_cpu_s, 1),
                                  FixedText(run.poses_cpu_s, 1),
                                  FixedText(run.all_cpu_s, 1),
                                  FixedText(run.wall_s, 1),
                                  std::to_string(run.points),
                                  std::to_string(errors.registered) + "/" + std::to_string(errors.of),
                                  FixedText(errors.mean_centre_mm, 5),
                                  FixedText(errors.mean_rotation_deg, 5)};
}

Status MeasureSet(const TruthSet& set, const SfmArguments& arguments) {
  std::vector<std::vector<std::string>> rows;
  const auto add = [&](const Result<SfmRun>& run) -> Status {
    DRUPE_RETURN_IF_ERROR(run.status());
    DRUPE_ASSIGN_OR_RETURN(std::vector<std::string> row, RowOf(set, *run));
    rows.push_back(std::move(row));
    return Status::Ok();
  };
  DRUPE_RETURN_IF_ERROR(add(RunOurs(set, arguments, SparseMethod::kClusters)));
  DRUPE_RETURN_IF_ERROR(add(RunOurs(set, arguments, SparseMethod::kWhole)));
  const bool with_peers = arguments.peers == "all";
  if (with_peers && FindProgram("colmap")) DRUPE_RETURN_IF_ERROR(add(RunColmapIn(set, arguments.exhaustive)));
  if (with_peers && HasOpenMvg()) DRUPE_RETURN_IF_ERROR(add(RunOpenMvgIn(set)));
  std::printf("%s: %zu pictures; CPU seconds by step\n", set.name.c_str(), set.views.size());
  const std::vector<std::string> heading = {"method", "features", "matching",   "poses",     "all",
                                            "wall s", "points",   "registered", "centre mm", "rotation deg"};
  std::fputs(FormatTextTable(heading, rows).c_str(), stdout);
  return Status::Ok();
}

Status Run(const SfmArguments& arguments) {
  return MeasureSets(arguments.sets, [&](const TruthSet& set) { return MeasureSet(set, arguments); });
}

}  // namespace

void AddSfmBench(CLI::App& bench, int& exit_code) {
  auto arguments = std::make_shared<SfmArguments>();
  CLI::App* command = bench.add_subcommand(
      "sfm",
      "Table 2 of the paper: what structure from motion costs and how far its poses are from the truth, after the "
      "best\n"
      "similarity: ours by clusters, ours as a whole, and, on the CPU with the same calibration, COLMAP (colmap) and\n"
      "OpenMVG 2 (openMVG_main_SfMInit_ImageListing, openMVG_main_SfM and the others) where they are on PATH");
  AddSetArguments(*command, "Sets with images, calibration and truth.json", arguments->sets);
  command->add_option("--peers", arguments->peers, "none: ours alone; all: whatever is on PATH as well")
      ->check(CLI::IsMember({"none", "all"}))
      ->capture_default_str();
  command->add_flag("--exhaustive", arguments->exhaustive,
                    "COLMAP matches all pairs instead of every picture with the four after it");
  command->add_flag("--without-board", arguments->without_board, "Ours sees no board, as COLMAP");
  command->callback([arguments, &exit_code] { exit_code = BenchExitCode(Run(*arguments)); });
}

}  // namespace drupe
