#pragma once

#include <functional>
#include <optional>
#include <span>

#include "base/run_context.h"
#include "base/status.h"
#include "geometry/pinhole_camera.h"
#include "scene/features.h"
#include "scene/view_graph.h"

namespace drupe {

/// What verifies the matches of a pair while the lens is a guess: an essential matrix with the guess, within a
/// tolerance wide enough for it; or a fundamental one, which asks nothing of the lens, but needs more of the matches to
/// be right.
enum class GuessedLens { kEssential, kFundamental };

/// How features of two pictures are matched and the matches verified.
struct MatchingOptions {
  double max_ratio = 0.7;     ///< 0..1; H of the paper's table 1: nearest distance over second nearest
  double max_error_px = 1.5;  ///< > 0; largest distance from the epipolar line (Sampson) of an inlier
  GuessedLens guessed_lens = GuessedLens::kEssential;
  double confidence = 0.9999;  ///< 0..1; RANSAC ends once a better model is less likely than 1 minus this
  int max_iterations = 2'000;  ///< RANSAC samples per pair
  int min_inliers = 20;        ///< pairs with fewer verified matches are dropped
  /// >= 0, degrees; pairs whose rays meet at less than this (median) are dropped: they measure no depth, and a
  /// repeating pattern matched with itself a period away looks like that.
  double min_angle_deg = 1.0;
  /// Features of each picture, the coarsest ones, that are compared with all of the other; the rest are matched along
  /// the epipolar lines these have given. 0: all are compared.
  int exhaustive_features = 2'000;
  bool guided = true;              ///< second matching along epipolar lines, over all features
  double guided_max_ratio = 0.7;   ///< 0..1; as max_ratio, among the candidates near the epipolar line
  bool drop_static = true;         ///< leave out features of the background that stands still in the picture
  double static_radius_px = 1.0;   ///< > 0; a static feature is found again within this distance ...
  double static_min_share = 0.25;  ///< 0..1; ... in at least this share of the other pictures

  /// 400 `invalid_option` naming the field that is out of its range.
  Status Check() const;
};

/// What is known of a pair: the verified matches, or nothing when it fails.
struct KnownPair {
  std::optional<TwoViewMatches> matches;
};
/// Gives what is known of a pair already, from matching it by itself (SetMatcher); nothing: it has to be matched.
/// Called from several threads.
using FindKnownPair = std::function<std::optional<KnownPair>(const ImagePair& pair)>;

/// Matches every pair of `clusters.pairs` and verifies it: descriptors by ratio and mutual check, then an essential
/// matrix by a locally optimised RANSAC. All pictures share `camera`; where it is a guess, `options.guessed_lens` says
/// how pairs are verified. Pairs that fail are left out. `find_known` may be empty. Errors: 400 `invalid_option`, 400
/// `invalid_pair`, `cancelled`.
Result<MatchGraph> RunMatching(std::span<const Features> features, const ViewClusters& clusters,
                               const PinholeCamera& camera, const MatchingOptions& options, const RunContext& context,
                               bool camera_is_guess = false, const FindKnownPair& find_known = nullptr);

}  // namespace drupe
