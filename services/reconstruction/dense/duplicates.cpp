#include "reconstruction/dense/duplicates.h"

#include <algorithm>
#include <cmath>
#include <unordered_map>

namespace drupe::dense {

namespace {

constexpr float kSamePlace = 0.75f;  ///< of a point's spacing

/// Points that stay, by cubes of space.
class KeptPoints {
 public:
  KeptPoints(const PointCloud& cloud, float side) : cloud_(cloud), per_side_(1 / side) {}

  void Add(const SeamPoint& point) { cubes_[KeyOf(CubeOf(point.index))].push_back(point); }

  /// True when a point of another view lies within `reach`, which is at most a cube's side.
  bool HasOther(const SeamPoint& point, float reach) const {
    const Eigen::Vector3i middle = CubeOf(point.index);
    for (int offset = 0; offset < 27; ++offset) {
      const Eigen::Vector3i cube = middle + Eigen::Vector3i(offset % 3 - 1, offset / 3 % 3 - 1, offset / 9 - 1);
      const auto found = cubes_.find(KeyOf(cube));
      if (found == cubes_.end()) continue;
      for (const SeamPoint& other : found->second) {
        if (other.owner == point.owner) continue;
        if ((cloud_.positions[other.index] - cloud_.positions[point.index]).norm() < reach) return true;
      }
    }
    return false;
  }

 private:
  Eigen::Vector3i CubeOf(std::uint32_t index) const {
    return (cloud_.positions[index] * per_side_).array().floor().cast<int>().matrix();
  }
  /// Cubes that are 2^21 apart share a key; the distance tells them apart.
  static std::uint64_t KeyOf(const Eigen::Vector3i& cube) {
    const auto part = [&](int axis) { return static_cast<std::uint64_t>(cube[axis]) & 0x1FFFFF; };
    return part(0) << 42 | part(1) << 21 | part(2);
  }

  const PointCloud& cloud_;
  float per_side_;
  std::unordered_map<std::uint64_t, std::vector<SeamPoint>> cubes_;
};

float MedianSpacing(const std::vector<SeamPoint>& seam) {
  std::vector<float> spacings;
  for (const SeamPoint& point : seam) spacings.push_back(point.spacing);
  const auto middle = spacings.begin() + static_cast<std::ptrdiff_t>(spacings.size() / 2);
  std::nth_element(spacings.begin(), middle, spacings.end());
  return *middle;
}

}  // namespace

std::vector<std::uint8_t> MarkDistinct(const PointCloud& cloud, std::vector<SeamPoint> seam) {
  std::vector<std::uint8_t> stays(cloud.size(), 1);
  if (seam.empty()) return stays;
  std::sort(seam.begin(), seam.end(), [](const SeamPoint& a, const SeamPoint& b) {
    return a.margin != b.margin ? a.margin > b.margin : a.index < b.index;
  });
  const float side = 2 * MedianSpacing(seam);
  KeptPoints kept(cloud, side);
  for (const SeamPoint& point : seam) {
    if (kept.HasOther(point, std::min(kSamePlace * point.spacing, side))) {
      stays[point.index] = 0;
    } else {
      kept.Add(point);
    }
  }
  return stays;
}

}  // namespace drupe::dense
