#include <CLI/CLI.hpp>
#include <cstdio>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "base/clock.h"
#include "cli/bench/bench.h"
#include "cli/bench/dense_truth.h"
#include "cli/bench/openmvs_peer.h"
#include "cli/bench/pmvs_peer.h"
#include "cli/bench/set_bench.h"
#include "cli/bench/text_table.h"
#include "image/decode.h"

namespace drupe {

namespace {

/// What the user wrote after `drupe bench dense`.
struct DenseArguments {
  SetArguments sets;
  std::string work = "bench-dense";
  bool no_peers = false;
};

struct Cost {
  double cpu_s = 0, wall_s = 0, peak_mb = 0;
};

std::vector<std::string> CostRow(const std::string& what, const Cost& cost, std::size_t points) {
  return {what, FixedText(cost.cpu_s, 1), FixedText(cost.wall_s, 1), FixedText(cost.peak_mb, 0),
          std::to_string(points)};
}

std::vector<std::string> ErrorCells(const DenseErrors& errors) {
  return {std::to_string(errors.on_fruit),
          FixedText(errors.median, 4),
          FixedText(errors.p95, 4),
          FixedText(errors.over_03_pct, 3),
          FixedText(errors.complete_010_pct, 2),
          FixedText(errors.complete_020_pct, 2),
          FixedText(errors.visible_020_pct, 2),
          errors.error_over_expected > 0 ? FixedText(errors.error_over_expected, 2) : "-"};
}

/// One line of the table: a method's cost and what its cloud is worth.
Status AddRow(const TruthSet& set, const Sim3& truth_from_model, const std::string& method, const Cost& cost,
              const PointCloud& cloud, std::vector<std::vector<std::string>>* rows) {
  DRUPE_ASSIGN_OR_RETURN(const DenseErrors errors, CompareCloud(set, cloud, truth_from_model));
  std::vector<std::string> row = CostRow(method, cost, cloud.size());
  for (const std::string& cell : ErrorCells(errors)) row.push_back(cell);
  rows->push_back(row);
  return Status::Ok();
}

/// Dense reconstruction alone, from a sparse model.
Result<PointCloud> RunDenseOn(const TruthSet& set, const SparseModel& model, const DenseOptions& options,
                              const RunContext& context, Cost* cost) {
  DenseInput input;
  input.model = &model;
  input.load_rgb = [&](int view) -> Result<RgbImage> {
    for (const SourceImage& image : set.input.images) {
      if (image.name != model.views[static_cast<std::size_t>(view)].image) continue;
      DRUPE_ASSIGN_OR_RETURN(const std::string bytes, image.read());
      return DecodeRgb(bytes, set.input.limits);
    }
    return InvalidArgument("bad_truth", "a view has no picture", "images");
  };
  const Stopwatch watch;
  Result<PointCloud> cloud = RunDense(input, options, context);
  *cost = {watch.CpuSeconds(), watch.WallSeconds(), ProcessPeakMb()};
  return cloud;
}

using RunPeerCloud = Result<PeerCloud> (*)(const TruthSet& set, const SparseModel& model, const std::string& directory,
                                           int threads);

/// A line for each other program that is on the machine, from our poses; their files go below `work`.
Status AddPeers(const TruthSet& set, const SparseModel& model, const Sim3& truth_from_model, const std::string& work,
                int threads, std::vector<std::vector<std::string>>* rows) {
  struct Peer {
    std::string folder, method;
    bool present;
    RunPeerCloud run;
  };
  const std::vector<Peer> peers = {{"pmvs2", "pmvs2, level 1 csize 2", FindProgram("pmvs2").has_value(), RunPmvs},
                                   {"openmvs", "OpenMVS, half resolution", HasOpenMvs(), RunOpenMvs}};
  for (const Peer& peer : peers) {
    if (!peer.present) continue;
    DRUPE_ASSIGN_OR_RETURN(const PeerCloud made, peer.run(set, model, work + "/" + peer.folder, threads));
    const Cost cost{made.run.cpu_s, made.run.wall_s, made.run.peak_mb};
    DRUPE_RETURN_IF_ERROR(AddRow(set, truth_from_model, peer.method, cost, made.cloud, rows));
  }
  return Status::Ok();
}

Status BenchSet(const TruthSet& set, const DenseArguments& arguments) {
  const RunContext context = arguments.sets.Context();
  ReconstructionOptions options;
  options.run_dense = false;
  DRUPE_ASSIGN_OR_RETURN(const ReconstructionOutput sparse, RunReconstruction(set.input, options, context));
  DRUPE_ASSIGN_OR_RETURN(const PoseErrors poses, ComparePoses(set, sparse.model.views));
  std::vector<std::vector<std::string>> rows = {
      CostRow("sparse", {sparse.timings.sparse_cpu_s, sparse.timings.sparse_wall_s, sparse.timings.peak_mb},
              sparse.model.tracks.size())};
  DenseOptions like_pmvs;
  like_pmvs.level = 1;
  like_pmvs.csize = 2;
  const std::vector<std::pair<std::string, DenseOptions>> runs = {{"dense, level 1 csize 2", like_pmvs},
                                                                  {"dense", DenseOptions()}};
  for (const auto& [name, dense_options] : runs) {
    Cost cost;
    DRUPE_ASSIGN_OR_RETURN(const PointCloud cloud, RunDenseOn(set, sparse.model, dense_options, context, &cost));
    DRUPE_RETURN_IF_ERROR(AddRow(set, poses.truth_from_model, name, cost, cloud, &rows));
  }
  if (!arguments.no_peers) {
    DRUPE_RETURN_IF_ERROR(AddPeers(set, sparse.model, poses.truth_from_model, arguments.work + "/" + set.name,
                                   context.ThreadCount(), &rows));
  }
  const std::string table =
      FormatTextTable({"stage", "CPU s", "wall s", "peak MB", "points", "on fruit", "median mm", "p95 mm", "> 0.3 mm %",
                       "at 0.10 %", "at 0.20 %", "visible %", "error/expected"},
                      rows);
  std::printf("%s\n%s\n", set.name.c_str(), table.c_str());
  return Status::Ok();
}

Status Run(const DenseArguments& arguments) {
  return MeasureSets(arguments.sets, [&](const TruthSet& set) { return BenchSet(set, arguments); });
}

}  // namespace

void AddDenseBench(CLI::App& bench, int& exit_code) {
  auto arguments = std::make_shared<DenseArguments>();
  CLI::App* command = bench.add_subcommand(
      "dense",
      "Time, memory and points of the sparse and the dense model (paper Table 3), and the cloud's error against the\n"
      "true skin: median, 95th percentile, share above 0.3 mm; completeness: share of the skin that three views face\n"
      "and that has a point within 0.10 and 0.20 mm ('visible': of the skin that no other fruit hides); and the 68th\n"
      "percentile of error by expected error, 1 when the cloud's own estimate is right. The same of pmvs2 and of\n"
      "OpenMVS (InterfaceCOLMAP, DensifyPointCloud), from our poses, where they are on PATH.");
  AddSetArguments(*command, "Sets with images/, calibration.json, truth.json and surface.ply", arguments->sets);
  command->add_option("--work", arguments->work, "Where the peers' files go")->capture_default_str();
  command->add_flag("--no-peers", arguments->no_peers, "Do not run other programs");
  command->callback([arguments, &exit_code] { exit_code = BenchExitCode(Run(*arguments)); });
}

}  // namespace drupe
