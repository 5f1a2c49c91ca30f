#include <CLI/CLI.hpp>
#include <array>
#include <cstdio>
#include <filesystem>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "base/clock.h"
#include "base/parallel.h"
#include "cli/bench/bench.h"
#include "cli/bench/match_truth.h"
#include "cli/bench/neighbour_pairs.h"
#include "cli/bench/set_bench.h"
#include "cli/bench/text_table.h"
#include "cli/bench/truth_set.h"
#include "reconstruction/matching/descriptor_matching.h"
#include "reconstruction/matching/matching.h"
#include "reconstruction/matching/static_features.h"
#include "reconstruction/view_features.h"

namespace drupe {

namespace {

constexpr std::array<double, 5> kRatios = {0.5, 0.6, 0.7, 0.8, 0.9};

/// What the user wrote after `drupe bench matching`.
struct MatchingArguments {
  SetArguments sets;
  int window = 1;
};

/// One set, ready to be matched.
struct Pictures {
  ViewFeatures views;
  std::vector<int> true_views;  ///< per picture, its number in the truth
  std::vector<ImagePair> pairs;
};

/// Matches of some kind, over all pairs.
struct Tally {
  double cpu_s = 0;
  std::size_t matches = 0;
  std::size_t wrong = 0;
};

Result<Pictures> LoadPictures(const TruthSet& set, int window, const RunContext& context) {
  Pictures pictures;
  ReconstructionInput input = set.input;
  input.board.reset();  // its corners are not needed
  DRUPE_ASSIGN_OR_RETURN(pictures.views, FindViewFeatures(input, ReconstructionOptions(), context));
  std::map<std::string, int> numbers;
  for (std::size_t i = 0; i < set.views.size(); ++i) numbers[Stem(set.views[i].image)] = static_cast<int>(i);
  for (const std::string& name : pictures.views.names) {
    const auto found = numbers.find(Stem(name));
    if (found == numbers.end()) return InvalidArgument("bad_truth", "truth.json has no view " + name, "views");
    pictures.true_views.push_back(found->second);
  }
  pictures.pairs = NeighbourPairs(static_cast<int>(pictures.views.names.size()), window);
  return pictures;
}

Eigen::Vector2d PixelOf(const Pictures& pictures, int view, std::uint32_t keypoint) {
  const Keypoint& found = pictures.views.features[view].keypoints[keypoint];
  return {found.x, found.y};
}

void Judge(const Pictures& pictures, const MatchTruth& truth, const ImagePair& pair,
           const std::vector<FeatureMatch>& matches, Tally& tally) {
  tally.matches += matches.size();
  for (const FeatureMatch& match : matches) {
    const bool wrong = truth.IsWrong(pictures.true_views[pair.first], PixelOf(pictures, pair.first, match.first),
                                     pictures.true_views[pair.second], PixelOf(pictures, pair.second, match.second));
    tally.wrong += wrong ? 1 : 0;
  }
}

/// Ratio test and mutual check alone, every feature with every other, the background's included.
Result<Tally> MatchPlainly(const Pictures& pictures, const PinholeCamera& camera, const MatchTruth& truth, double ratio,
                           const RunContext& context) {
  Tally tally;
  const Stopwatch watch;
  std::vector<PreparedPicture> prepared;
  for (const Features& features : pictures.views.features) {
    prepared.emplace_back(features, std::vector<std::uint8_t>(features.size(), 0), camera, 0);
  }
  std::vector<std::vector<FeatureMatch>> matches(pictures.pairs.size());
  DRUPE_RETURN_IF_ERROR(ParallelFor(context, pictures.pairs.size(), [&](std::size_t i) {
    matches[i] = MatchDescriptors(prepared[pictures.pairs[i].first], prepared[pictures.pairs[i].second], ratio);
  }));
  tally.cpu_s = watch.CpuSeconds();
  for (std::size_t i = 0; i < matches.size(); ++i) Judge(pictures, truth, pictures.pairs[i], matches[i], tally);
  return tally;
}

/// The whole matching stage with this ratio.
Result<Tally> MatchVerified(const Pictures& pictures, const PinholeCamera& camera, const MatchTruth& truth,
                            double ratio, const RunContext& context) {
  Tally tally;
  MatchingOptions options;
  options.max_ratio = ratio;
  ViewClusters clusters;
  clusters.pairs = pictures.pairs;
  const Stopwatch watch;
  DRUPE_ASSIGN_OR_RETURN(const MatchGraph graph,
                         RunMatching(pictures.views.features, clusters, camera, options, context));
  tally.cpu_s = watch.CpuSeconds();
  for (const TwoViewMatches& pair : graph.pairs) Judge(pictures, truth, pair.pair, pair.matches, tally);
  return tally;
}

void AppendCells(const Tally& tally, std::vector<std::string>& row) {
  row.push_back(FixedText(tally.cpu_s, 2));
  row.push_back(std::to_string(tally.matches));
  row.push_back(std::to_string(tally.wrong));
  row.push_back(FixedText(
      tally.matches == 0 ? 0.0 : 100.0 * static_cast<double>(tally.wrong) / static_cast<double>(tally.matches), 2));
}

Status MeasureSet(const TruthSet& set, const MatchingArguments& arguments) {
  const RunContext context = arguments.sets.Context();
  DRUPE_ASSIGN_OR_RETURN(const MatchTruth truth, MatchTruth::Load(set));
  DRUPE_ASSIGN_OR_RETURN(const Pictures pictures, LoadPictures(set, arguments.window, context));
  const PinholeCamera& camera = set.input.calibration->camera;
  std::vector<std::vector<std::string>> rows;
  for (const double ratio : kRatios) {
    std::vector<std::string> row = {FixedText(ratio, 1)};
    DRUPE_ASSIGN_OR_RETURN(const Tally plain, MatchPlainly(pictures, camera, truth, ratio, context));
    AppendCells(plain, row);
    DRUPE_ASSIGN_OR_RETURN(const Tally verified, MatchVerified(pictures, camera, truth, ratio, context));
    AppendCells(verified, row);
    rows.push_back(std::move(row));
  }
  std::printf("%s: %zu pictures, %zu pairs; wrong: over %.0f px off the true epipolar line%s\n", set.name.c_str(),
              pictures.views.names.size(), pictures.pairs.size(), MatchTruth::kMaxEpipolarPx,
              truth.has_surface() ? ", or over 8 px off where the true surface lies" : "");
  const std::vector<std::string> heading = {"ratio", "CPU s",    "matches", "wrong", "%",
                                            "CPU s", "verified", "wrong",   "%"};
  std::fputs(FormatTextTable(heading, rows).c_str(), stdout);
  return Status::Ok();
}

Status Run(const MatchingArguments& arguments) {
  return MeasureSets(arguments.sets, [&](const TruthSet& set) { return MeasureSet(set, arguments); });
}

}  // namespace

void AddMatchingBench(CLI::App& bench, int& exit_code) {
  auto arguments = std::make_shared<MatchingArguments>();
  CLI::App* command = bench.add_subcommand(
      "matching",
      "Table 1 of the paper: matches and wrong ones by the ratio threshold H, first by ratio test and mutual check "
      "alone\n(every feature, background included), then after the whole matching stage (static features dropped, "
      "RANSAC,\nguided second matching)");
  AddSetArguments(*command, "Sets with images, calibration, truth.json and perhaps surface.ply", arguments->sets);
  command->add_option("--window", arguments->window, "Pair every picture with so many that follow it")
      ->check(CLI::Range(1, 100));
  command->callback([arguments, &exit_code] { exit_code = BenchExitCode(Run(*arguments)); });
}

}  // namespace drupe
