#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "geometry/rigid3.h"

namespace drupe {

/// Similarity of every pair of images (paper 3.1.1). Symmetric, image_count x image_count.
struct SimilarityGraph {
  int image_count = 0;
  std::vector<float> fisher_distance;  ///< row-major; 0 on the diagonal
  /// Edge weight: global extreme of the Fisher distance minus the pair's distance; >= 0, larger is more alike.
  std::vector<float> weight;

  float Distance(int a, int b) const { return fisher_distance[static_cast<std::size_t>(a) * image_count + b]; }
  float Weight(int a, int b) const { return weight[static_cast<std::size_t>(a) * image_count + b]; }
};

/// A pair of images to be matched, first < second.
struct ImagePair {
  int first = 0;
  int second = 0;
  bool operator==(const ImagePair&) const = default;
};

/// Overlapping groups of similar images (paper eq. 4): sizes at most max_cluster_size, joined by shared images.
struct ViewClusters {
  std::vector<std::vector<int>> clusters;  ///< image indices, ascending within a cluster
  std::vector<ImagePair> pairs;            ///< every pair to be matched, inside clusters and between them, ascending
};

/// A match of keypoint `first` in one image with `second` in the other.
struct FeatureMatch {
  std::uint32_t first = 0;
  std::uint32_t second = 0;
};

/// Geometrically verified matches of one pair.
struct TwoViewMatches {
  ImagePair pair;
  std::vector<FeatureMatch> matches;  ///< inliers, ascending by `first`
  int putative_count = 0;             ///< matches before the geometric check
  /// Relative pose, second camera from first; |translation| = 1. Only when `calibrated`.
  Rigid3 second_from_first;
  bool calibrated = false;
  double median_triangulation_angle_rad = 0;
  double homography_inlier_share = 0;  ///< of the inliers; near 1 means a plane or no parallax
};

/// One keypoint of one view.
struct FeatureRef {
  std::int32_t view = 0;
  std::uint32_t keypoint = 0;
  bool operator==(const FeatureRef&) const = default;
};

/// Features of different views that show one surface point.
struct TrackList {
  /// Ascending by view within a track, at most one feature a view; tracks ascending by their first feature.
  std::vector<std::vector<FeatureRef>> tracks;
};

/// The verified pairs of an image set, ascending by pair.
struct MatchGraph {
  std::vector<TwoViewMatches> pairs;
  /// Per image, per keypoint: 1 when the keypoint stands still in the picture while the fruit turns (background), and
  /// was therefore left out of matching.
  std::vector<std::vector<std::uint8_t>> is_static;
};

}  // namespace drupe
