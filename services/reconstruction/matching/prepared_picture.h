#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "geometry/pinhole_camera.h"
#include "reconstruction/matching/nearest.h"
#include "scene/features.h"

namespace drupe {

/// What matching needs of one picture, computed once for all its pairs.
struct PreparedPicture {
  PreparedPicture() = default;
  /// Leaves out the keypoints whose entry of `is_static` is not 0; packs the first `exhaustive_features` of the rest
  /// (all of them when 0).
  PreparedPicture(const Features& picture, const std::vector<std::uint8_t>& is_static, const PinholeCamera& camera,
                  int exhaustive_features);

  const Features* features = nullptr;
  std::vector<std::uint32_t> kept;      ///< keypoints that take part, ascending
  std::vector<Eigen::Vector2d> places;  ///< of the kept ones: normalised coordinates without distortion
  PackedDescriptors packed;             ///< of the first of the kept ones

  const std::uint8_t* Descriptor(std::uint32_t i) const { return features->Descriptor(kept[i]); }
};

}  // namespace drupe
