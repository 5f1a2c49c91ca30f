#pragma once

#include "base/status.h"

namespace drupe {

/// How the model of a set of several clusters is built: each cluster on its own, then fused (paper 3.1.2), or all views
/// in one.
enum class SparseMethod { kClusters, kWhole };
/// How adjustments are solved: by exact block elimination distributed over the clusters, or as one problem by Ceres.
enum class AdjustmentMethod { kDistributed, kMonolithic };

/// Options of incremental structure from motion.
struct SparseOptions {
  SparseMethod method = SparseMethod::kClusters;
  AdjustmentMethod adjustment = AdjustmentMethod::kDistributed;
  /// An observation farther than this from its track's projection is dropped, pixels of the full picture.
  double max_reprojection_error_px = 4.0;
  /// A track whose widest pair of rays meets at less than this is dropped, degrees.
  double min_triangulation_angle_deg = 2.0;
  /// Largest scale of the robust (Cauchy) loss on features in the adjustments, pixels. The final ones take 2.4 times
  /// the noise that they find where that is less, so that observations that are off by a few times the noise weigh
  /// little.
  double feature_loss_px = 1.0;
  /// Scale of the robust (Cauchy) loss on board corners in the adjustments, pixels.
  double board_loss_px = 0.5;
  /// Fewest inliers with which a view is placed.
  int min_pnp_inliers = 15;
  /// Largest number of RANSAC samples a view.
  int max_ransac_iterations = 2000;
  /// Views with this many board corners or more are placed by the board when features cannot, and count for the frame.
  int min_board_corners = 8;
  /// The frame and scale are the board's when at least this many views see it.
  int min_board_views = 3;
  /// Fewer registered views than this share is an error.
  double min_registered_share = 0.6;
  /// Before the last adjustment tracks take in the features that lie where their points project and look like them, and
  /// tracks of one point become one. Needs the features' descriptors.
  bool complete_tracks = true;
  /// Every cluster's model is a part that another machine may build.
  bool parts = false;

  /// The message names the option, its value and its range.
  Status Check() const;
};

}  // namespace drupe
