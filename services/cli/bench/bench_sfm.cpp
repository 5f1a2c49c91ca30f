#include <CLI/CLI.hpp>
#include <cstdio>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "base/ids.h"
#include "cli/bench/bench.h"
#include "cli/bench/colmap_peer.h"
#include "cli/bench/peer_process.h"
#include "cli/bench/sfm_run.h"
#include "cli/bench/text_table.h"
#include "cli/bench/truth_set.h"

namespace drupe {

namespace {

/// What the user wrote after `drupe bench sfm`.
struct Arguments {
  std::vector<std::string> sets;
  std::string peers = "all";
  bool exhaustive = false;
  bool without_board = false;
  int threads = 0;
};

double StageCpu(const Timings& timings, const std::string& name) {
  double cpu_s = 0;
  for (const StageTiming& stage : timings.stages) cpu_s += stage.name == name ? stage.cpu_s : 0;
  return cpu_s;
}

Result<SfmRun> RunOurs(const TruthSet& set, const Arguments& arguments, SparseMethod method) {
  ReconstructionInput input = set.input;
  if (arguments.without_board) input.board.reset();
  ReconstructionOptions options;
  options.run_dense = false;
  options.sparse.method = method;
  RunContext context;
  context.threads = arguments.threads;
  DRUPE_ASSIGN_OR_RETURN(const ReconstructionOutput output, RunReconstruction(input, options, context));
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

Status MeasureSet(const std::string& directory, const Arguments& arguments) {
  DRUPE_ASSIGN_OR_RETURN(const TruthSet set, LoadTruthSet(directory));
  std::vector<std::vector<std::string>> rows;
  const auto add = [&](const Result<SfmRun>& run) -> Status {
    DRUPE_RETURN_IF_ERROR(run.status());
    DRUPE_ASSIGN_OR_RETURN(std::vector<std::string> row, RowOf(set, *run));
    rows.push_back(std::move(row));
    return Status::Ok();
  };
  DRUPE_RETURN_IF_ERROR(add(RunOurs(set, arguments, SparseMethod::kClusters)));
  DRUPE_RETURN_IF_ERROR(add(RunOurs(set, arguments, SparseMethod::kWhole)));
  if (arguments.peers == "all" && FindProgram("colmap")) {
    DRUPE_RETURN_IF_ERROR(add(RunColmapIn(set, arguments.exhaustive)));
  }
  std::printf("%s: %zu pictures; CPU seconds by step\n", set.name.c_str(), set.views.size());
  const std::vector<std::string> heading = {"method", "features", "matching",   "poses",     "all",
                                            "wall s", "points",   "registered", "centre mm", "rotation deg"};
  std::fputs(FormatTextTable(heading, rows).c_str(), stdout);
  return Status::Ok();
}

Status Run(const Arguments& arguments) {
  for (const std::string& directory : arguments.sets) DRUPE_RETURN_IF_ERROR(MeasureSet(directory, arguments));
  return Status::Ok();
}

}  // namespace

void AddSfmBench(CLI::App& bench, int& exit_code) {
  auto arguments = std::make_shared<Arguments>();
  CLI::App* command = bench.add_subcommand(
      "sfm",
      "Table 2 of the paper: what structure from motion costs and how far its poses are from the truth, after the "
      "best\n"
      "similarity: ours by clusters, ours as a whole, and COLMAP on the CPU with the same calibration where it is on "
      "PATH");
  command->add_option("SET_DIR", arguments->sets, "Sets with images, calibration and truth.json")->required();
  command->add_option("--peers", arguments->peers, "none: ours alone; all: whatever is on PATH as well")
      ->check(CLI::IsMember({"none", "all"}))
      ->capture_default_str();
  command->add_flag("--exhaustive", arguments->exhaustive,
                    "COLMAP matches all pairs instead of every picture with the four after it");
  command->add_flag("--without-board", arguments->without_board, "Ours sees no board, as COLMAP");
  command->add_option("--threads", arguments->threads, "Ours: threads; 0: one a core")->check(CLI::Range(0, 1024));
  command->callback([arguments, &exit_code] { exit_code = BenchExitCode(Run(*arguments)); });
}

}  // namespace drupe
