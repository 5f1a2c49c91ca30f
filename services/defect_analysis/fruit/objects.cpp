#include "defect_analysis/fruit/objects.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace drupe {
namespace {

constexpr double kMaxVoxels = 16e6;
constexpr std::size_t kSample = 50000;
constexpr double kTail = 0.002;
constexpr std::int32_t kNone = -1;

// A dense grid of voxels over a box, with a border of one empty voxel so that neighbours need no bounds check.
class VoxelGrid {
 public:
  VoxelGrid(const CloudBox& box, double edge) {
    const Eigen::Vector3d size = (box.high - box.low).cwiseMax(1e-9);
    edge = std::max(edge, std::cbrt(size.prod() / kMaxVoxels));
    // A flat or thin box still has a border on every side, which the product above does not count.
    while (((size / edge).array() + 3).prod() > 2 * kMaxVoxels) edge *= 1.2;
    inverse_edge_ = static_cast<float>(1 / edge);
    low_ = box.low.cast<float>();
    for (int axis = 0; axis < 3; ++axis) count_[axis] = static_cast<int>(size[axis] / edge) + 3;
  }

  std::size_t size() const { return static_cast<std::size_t>(count_[0]) * count_[1] * count_[2]; }

  // The voxel of a point, or kNone outside the box.
  std::int32_t VoxelOf(const Eigen::Vector3f& x) const {
    std::int32_t index = 0;
    for (int axis = 2; axis >= 0; --axis) {
      const float place = (x[axis] - low_[axis]) * inverse_edge_;
      if (!(place >= 0 && place < static_cast<float>(count_[axis] - 2))) return kNone;
      index = index * count_[axis] + static_cast<int>(place) + 1;
    }
    return index;
  }

  std::array<std::int32_t, 26> NeighbourSteps() const {
    std::array<std::int32_t, 26> steps;
    int k = 0;
    for (int z = -1; z <= 1; ++z) {
      for (int y = -1; y <= 1; ++y) {
        for (int x = -1; x <= 1; ++x) {
          if (x != 0 || y != 0 || z != 0) steps[k++] = (z * count_[1] + y) * count_[0] + x;
        }
      }
    }
    return steps;
  }

 private:
  Eigen::Vector3f low_;
  float inverse_edge_ = 1;
  std::array<int, 3> count_{};
};

// Voxels with less than an eighth of the usual number of points hold strays, and would join neighbouring fruits.
std::uint32_t OccupiedFrom(const std::vector<std::uint32_t>& counts) {
  std::vector<std::uint32_t> occupied;
  std::copy_if(counts.begin(), counts.end(), std::back_inserter(occupied), [](std::uint32_t c) { return c > 0; });
  if (occupied.empty()) return 1;
  const auto middle = occupied.begin() + static_cast<std::ptrdiff_t>(occupied.size() / 2);
  std::nth_element(occupied.begin(), middle, occupied.end());
  return std::max<std::uint32_t>(1, *middle / 8);
}

// Numbers the connected components of the occupied voxels; returns how many there are.
int LabelComponents(const VoxelGrid& grid, const std::vector<std::uint32_t>& counts,
                    std::vector<std::int32_t>& labels) {
  const std::uint32_t from = OccupiedFrom(counts);
  const auto steps = grid.NeighbourSteps();
  std::vector<std::int32_t> stack;
  int components = 0;
  for (std::size_t seed = 0; seed < counts.size(); ++seed) {
    if (counts[seed] < from || labels[seed] != kNone) continue;
    labels[seed] = components;
    stack.push_back(static_cast<std::int32_t>(seed));
    while (!stack.empty()) {
      const std::int32_t voxel = stack.back();
      stack.pop_back();
      for (const std::int32_t step : steps) {
        const std::int32_t other = voxel + step;
        if (counts[other] < from || labels[other] != kNone) continue;
        labels[other] = components;
        stack.push_back(other);
      }
    }
    ++components;
  }
  return components;
}

}  // namespace

CloudBox RobustBox(const PointCloud& cloud) {
  const std::size_t step = std::max<std::size_t>(1, cloud.size() / kSample);
  std::array<std::vector<float>, 3> axes;
  for (std::size_t i = 0; i < cloud.size(); i += step) {
    if (!cloud.positions[i].allFinite()) continue;
    for (int axis = 0; axis < 3; ++axis) axes[axis].push_back(cloud.positions[i][axis]);
  }
  CloudBox box;
  if (axes[0].empty()) return box;
  for (int axis = 0; axis < 3; ++axis) {
    std::sort(axes[axis].begin(), axes[axis].end());
    const auto tail = static_cast<std::size_t>(kTail * static_cast<double>(axes[axis].size()));
    box.low[axis] = axes[axis][tail];
    box.high[axis] = axes[axis][axes[axis].size() - 1 - tail];
  }
  const Eigen::Vector3d margin = 0.05 * (box.high - box.low);  // the quantiles cut a little off every side
  box.low -= margin;
  box.high += margin;
  return box;
}

std::vector<std::vector<std::uint32_t>> FindObjects(const PointCloud& cloud, const CloudBox& box,
                                                    const std::optional<Ground>& ground, double clearance, double voxel,
                                                    int min_points) {
  const VoxelGrid grid(box, voxel);
  std::vector<std::uint32_t> counts(grid.size(), 0);
  std::vector<std::int32_t> voxel_of(cloud.size(), kNone);
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    if (ground && ground->HeightOf(cloud.positions[i]) < clearance) continue;
    voxel_of[i] = grid.VoxelOf(cloud.positions[i]);
    if (voxel_of[i] != kNone) ++counts[voxel_of[i]];
  }
  std::vector<std::int32_t> labels(grid.size(), kNone);
  std::vector<std::vector<std::uint32_t>> objects(LabelComponents(grid, counts, labels));
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    const std::int32_t label = voxel_of[i] == kNone ? kNone : labels[voxel_of[i]];
    if (label != kNone) objects[label].push_back(static_cast<std::uint32_t>(i));
  }
  std::erase_if(objects, [&](const auto& object) { return static_cast<int>(object.size()) < min_points; });
  std::stable_sort(objects.begin(), objects.end(), [](const auto& a, const auto& b) { return a.size() > b.size(); });
  return objects;
}

}  // namespace drupe
