#pragma once

#include "geometry/rigid3.h"
#include "scene/archive.h"
#include "scene/view_graph.h"

/// The fields of a view graph for an archive, which finds them through their arguments.
namespace drupe {

template <typename Archive>
void Fields(Archive& archive, Rigid3& pose) {
  archive(pose.rotation, pose.translation);
}

template <typename Archive>
void Fields(Archive& archive, ImagePair& pair) {
  archive(pair.first, pair.second);
}

template <typename Archive>
void Fields(Archive& archive, FeatureMatch& match) {
  archive(match.first, match.second);
}

template <typename Archive>
void Fields(Archive& archive, TwoViewMatches& pair) {
  archive(pair.pair, pair.matches, pair.putative_count, pair.second_from_first, pair.calibrated,
          pair.median_triangulation_angle_rad, pair.homography_inlier_share);
}

}  // namespace drupe
