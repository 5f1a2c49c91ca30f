#include "reconstruction/matching/matching.h"

#include <algorithm>
#include <mutex>
#include <optional>
#include <string>

#include "base/option_check.h"
#include "base/parallel.h"
#include "reconstruction/matching/prepared_picture.h"
#include "reconstruction/matching/set_matcher.h"
#include "reconstruction/matching/static_features.h"

namespace drupe {
namespace {

Status CheckPairs(const ViewClusters& clusters, std::size_t image_count) {
  for (const ImagePair& pair : clusters.pairs) {
    if (pair.first >= 0 && pair.first < pair.second && pair.second < static_cast<int>(image_count)) continue;
    return InvalidArgument("invalid_pair", "the pair " + std::to_string(pair.first) + ", " +
                                               std::to_string(pair.second) + " is not one of two pictures of the set");
  }
  return Status::Ok();
}

Result<std::vector<std::vector<std::uint8_t>>> StaticOrNone(std::span<const Features> features,
                                                            const MatchingOptions& options, const RunContext& context) {
  if (options.drop_static) {
    return FindStaticFeatures(features, options.static_radius_px, options.static_min_share, context);
  }
  std::vector<std::vector<std::uint8_t>> none;
  for (const Features& picture : features) none.emplace_back(picture.size(), 0);
  return none;
}

/// Per pair, in their order.
using Known = std::vector<std::optional<KnownPair>>;

Result<Known> FindKnown(const std::vector<ImagePair>& pairs, const FindKnownPair& find, const RunContext& context) {
  Known known(pairs.size());
  if (!find) return known;
  DRUPE_RETURN_IF_ERROR(ParallelFor(context, pairs.size(), [&](std::size_t i) { known[i] = find(pairs[i]); }));
  return known;
}

/// The pictures of which a pair has to be matched; the others are left empty.
Result<std::vector<PreparedPicture>> PrepareUnknown(std::span<const Features> features, const MatchGraph& graph,
                                                    const std::vector<ImagePair>& pairs, const Known& known,
                                                    const SetMatcher& matcher, const RunContext& context) {
  std::vector<std::uint8_t> is_needed(features.size(), 0);
  for (std::size_t i = 0; i < pairs.size(); ++i) {
    if (!known[i]) is_needed[pairs[i].first] = is_needed[pairs[i].second] = 1;
  }
  std::vector<PreparedPicture> pictures(features.size());
  DRUPE_RETURN_IF_ERROR(ParallelFor(context, features.size(), [&](std::size_t i) {
    if (is_needed[i] != 0) pictures[i] = matcher.Prepare(features[i], graph.is_static[i]);
  }));
  return pictures;
}

}  // namespace

Status MatchingOptions::Check() const {
  DRUPE_RETURN_IF_ERROR(CheckOption(max_ratio > 0 && max_ratio <= 1, "max_ratio", "above 0 and up to 1"));
  DRUPE_RETURN_IF_ERROR(CheckOption(max_error_px > 0 && max_error_px <= 100, "max_error_px", "above 0 and up to 100"));
  DRUPE_RETURN_IF_ERROR(CheckOption(confidence > 0 && confidence < 1, "confidence", "between 0 and 1"));
  DRUPE_RETURN_IF_ERROR(
      CheckOption(max_iterations >= 1 && max_iterations <= 1'000'000, "max_iterations", "1 to 1000000"));
  DRUPE_RETURN_IF_ERROR(CheckOption(min_inliers >= 5, "min_inliers", "5 or more"));
  DRUPE_RETURN_IF_ERROR(CheckOption(min_angle_deg >= 0 && min_angle_deg < 90, "min_angle_deg", "0 up to 90"));
  DRUPE_RETURN_IF_ERROR(CheckOption(exhaustive_features >= 0, "exhaustive_features", "0 or more"));
  DRUPE_RETURN_IF_ERROR(
      CheckOption(guided_max_ratio > 0 && guided_max_ratio <= 1, "guided_max_ratio", "above 0 and up to 1"));
  DRUPE_RETURN_IF_ERROR(
      CheckOption(static_radius_px > 0 && static_radius_px <= 100, "static_radius_px", "above 0 and up to 100"));
  return CheckOption(static_min_share > 0 && static_min_share <= 1, "static_min_share", "above 0 and up to 1");
}

Result<MatchGraph> RunMatching(std::span<const Features> features, const ViewClusters& clusters,
                               const PinholeCamera& camera, const MatchingOptions& options, const RunContext& context,
                               bool camera_is_guess, const FindKnownPair& find_known) {
  DRUPE_RETURN_IF_ERROR(options.Check());
  DRUPE_RETURN_IF_ERROR(CheckPairs(clusters, features.size()));
  const std::vector<ImagePair>& pairs = clusters.pairs;
  MatchGraph graph;
  DRUPE_ASSIGN_OR_RETURN(graph.is_static, StaticOrNone(features, options, context));
  DRUPE_ASSIGN_OR_RETURN(Known found, FindKnown(pairs, find_known, context));
  const SetMatcher matcher(camera, camera_is_guess, options, context.seed);
  DRUPE_ASSIGN_OR_RETURN(const std::vector<PreparedPicture> pictures,
                         PrepareUnknown(features, graph, pairs, found, matcher, context));
  std::mutex mutex;
  std::size_t done = 0;  // guarded by mutex
  DRUPE_RETURN_IF_ERROR(ParallelFor(context, pairs.size(), [&](std::size_t i) {
    const ImagePair& pair = pairs[i];
    if (!found[i]) found[i] = KnownPair{matcher.Match(pictures[pair.first], pictures[pair.second], pair)};
    const std::lock_guard lock(mutex);
    context.Report("matching", static_cast<double>(++done) / static_cast<double>(pairs.size()));
  }));
  for (std::optional<KnownPair>& pair : found) {
    if (pair->matches) graph.pairs.push_back(*std::move(pair->matches));
  }
  return graph;
}

}  // namespace drupe
