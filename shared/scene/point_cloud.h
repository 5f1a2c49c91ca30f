#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

namespace drupe {

/// A dense cloud, structure of arrays; every vector has the same length, or is empty where a source does not know it.
struct PointCloud {
  std::vector<Eigen::Vector3f> positions;  ///< mm when the scale is metric
  std::vector<Eigen::Vector3f> normals;    ///< unit length, away from the surface
  /// sRGB of the skin itself: robust mean over the views, highlights rejected, the lamps' diffuse shading divided out
  /// where it is known (albedo up to a factor).
  std::vector<Eigen::Matrix<std::uint8_t, 3, 1>> colours;
  std::vector<Eigen::Matrix<std::uint8_t, 3, 1>> raw_colours;  ///< the same mean with the shading left in, as pictured
  std::vector<std::uint8_t> view_counts;                       ///< views that agree on the point
  std::vector<float> ncc;             ///< mean normalised cross-correlation over those views, -1..1
  std::vector<float> expected_error;  ///< standard uncertainty along the normal, same unit as positions

  std::size_t size() const { return positions.size(); }
  bool empty() const { return positions.empty(); }
};

}  // namespace drupe
