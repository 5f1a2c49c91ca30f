#include "reconstruction/dense/preview.h"

#include <algorithm>
#include <cmath>
#include <type_traits>
#include <unordered_map>

namespace drupe {

namespace {

/// The cubes of a grid that hold points: a number for each, in the order of their first points.
struct CubeNumbers {
  std::vector<std::uint32_t> of_point;
  std::uint32_t count = 0;
};

CubeNumbers NumberCubes(const PointCloud& cloud, const Eigen::Vector3f& low, float side) {
  CubeNumbers cubes;
  std::unordered_map<std::uint64_t, std::uint32_t> numbers;
  cubes.of_point.reserve(cloud.size());
  for (const Eigen::Vector3f& position : cloud.positions) {
    const Eigen::Vector3f at = (position - low) / side;
    const auto part = [&](int axis) { return static_cast<std::uint64_t>(std::clamp(at[axis], 0.0f, 2e6f)); };
    const auto [entry, added] = numbers.try_emplace(part(0) << 42 | part(1) << 21 | part(2), cubes.count);
    if (added) ++cubes.count;
    cubes.of_point.push_back(entry->second);
  }
  return cubes;
}

/// The grid that holds about `target` cubes: points lie on a surface, so their number goes with the inverse square of
/// the side.
CubeNumbers FitGrid(const PointCloud& cloud, std::size_t target) {
  constexpr int kTries = 8;
  constexpr double kCloseEnough = 0.02;
  Eigen::Vector3f low = cloud.positions[0], high = low;
  for (const Eigen::Vector3f& position : cloud.positions) {
    low = low.cwiseMin(position);
    high = high.cwiseMax(position);
  }
  float side = std::max((high - low).norm() / std::sqrt(static_cast<float>(target)), 1e-12f);
  CubeNumbers cubes = NumberCubes(cloud, low, side);
  for (int i = 0; i < kTries; ++i) {
    const double ratio = static_cast<double>(cubes.count) / static_cast<double>(target);
    if (std::abs(ratio - 1) < kCloseEnough) break;
    side *= static_cast<float>(std::sqrt(ratio));
    cubes = NumberCubes(cloud, low, side);
  }
  return cubes;
}

/// Means over the members of every cube; `values` may be empty.
template <typename T, typename Mean>
std::vector<T> Average(const std::vector<T>& values, const CubeNumbers& cubes, const Mean& zero) {
  if (values.empty()) return {};
  std::vector<Mean> sums(cubes.count, zero);
  std::vector<float> members(cubes.count, 0);
  for (std::size_t i = 0; i < values.size(); ++i) {
    if constexpr (std::is_arithmetic_v<T>) {
      sums[cubes.of_point[i]] += static_cast<Mean>(values[i]);
    } else {
      sums[cubes.of_point[i]] += values[i].template cast<double>();
    }
    ++members[cubes.of_point[i]];
  }
  std::vector<T> means(cubes.count);
  for (std::size_t cube = 0; cube < means.size(); ++cube) {
    const Mean mean = sums[cube] / members[cube];
    if constexpr (std::is_same_v<T, std::uint8_t>) {
      means[cube] = static_cast<std::uint8_t>(mean + 0.5);
    } else if constexpr (std::is_arithmetic_v<T>) {
      means[cube] = static_cast<T>(mean);
    } else if constexpr (std::is_same_v<typename T::Scalar, std::uint8_t>) {
      means[cube] = (mean.array() + 0.5).template cast<std::uint8_t>().matrix();
    } else {
      means[cube] = mean.template cast<float>();
    }
  }
  return means;
}

}  // namespace

PointCloud DecimateCloud(const PointCloud& cloud, std::size_t target) {
  if (cloud.size() <= target || target == 0) return cloud;
  const CubeNumbers cubes = FitGrid(cloud, target);
  const Eigen::Vector3d zero = Eigen::Vector3d::Zero();
  PointCloud small;
  small.positions = Average(cloud.positions, cubes, zero);
  small.normals = Average(cloud.normals, cubes, zero);
  for (Eigen::Vector3f& normal : small.normals) normal.normalize();
  small.colours = Average(cloud.colours, cubes, zero);
  small.raw_colours = Average(cloud.raw_colours, cubes, zero);
  small.view_counts = Average(cloud.view_counts, cubes, 0.0);
  small.ncc = Average(cloud.ncc, cubes, 0.0);
  small.expected_error = Average(cloud.expected_error, cubes, 0.0);
  return small;
}

}  // namespace drupe
