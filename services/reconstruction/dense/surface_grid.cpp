#include "reconstruction/dense/surface_grid.h"

#include <algorithm>

namespace drupe::dense {

namespace {

constexpr double kMostCubes = 1 << 24;

}  // namespace

SurfaceGrid::SurfaceGrid(const std::vector<Eigen::Vector3f>& positions, float edge) {
  if (positions.empty()) return;
  Eigen::Array3f low = positions.front().array(), high = low;
  for (const Eigen::Vector3f& position : positions) {
    low = low.min(position.array());
    high = high.max(position.array());
  }
  const auto cubes = [&] { return ((high - low) / edge + 1.0f).cast<double>().prod(); };
  while (cubes() > kMostCubes) edge *= 2;
  origin_ = low;
  per_edge_ = 1 / edge;
  size_ = ((high - low) * per_edge_).cast<int>() + 1;
  index_.assign(static_cast<std::size_t>(size_.x()) * size_.y() * size_.z(), kNone);
  for (const Eigen::Vector3f& position : positions) {
    const Eigen::Array3i coordinates = ((position.array() - origin_) * per_edge_).cast<int>().min(size_ - 1);
    std::int32_t& cell =
        index_[(static_cast<std::size_t>(coordinates.x()) * size_.y() + coordinates.y()) * size_.z() + coordinates.z()];
    if (cell != kNone) continue;
    cell = static_cast<std::int32_t>(cells_.size());
    cells_.push_back(coordinates);
  }
}

int SurfaceGrid::IndexOf(const Eigen::Array3i& coordinates) const {
  if ((coordinates < 0).any() || (coordinates >= size_).any()) return kNone;
  return index_[(static_cast<std::size_t>(coordinates.x()) * size_.y() + coordinates.y()) * size_.z() +
                coordinates.z()];
}

int SurfaceGrid::CellOf(const Eigen::Vector3f& position) const {
  const Eigen::Array3f at = ((position.array() - origin_) * per_edge_).floor();
  if ((at < 0).any() || (at > size_.cast<float>()).any()) return kNone;
  return IndexOf(at.cast<int>().min(size_ - 1));
}

SurfaceGrid::Place SurfaceGrid::At(const Eigen::Vector3f& position) const {
  const Eigen::Array3f at = (position.array() - origin_) * per_edge_ - 0.5f;  // in cells, from centre to centre
  const Eigen::Array3f low = at.floor();
  const Eigen::Array3f share = at - low;
  Place place;
  for (int corner = 0; corner < 8; ++corner) {
    const Eigen::Array3i step(corner & 1, corner >> 1 & 1, corner >> 2);
    place.cells[corner] = IndexOf(low.cast<int>() + step);
    const Eigen::Array3f weights = (step == 1).select(share, 1.0f - share);
    place.weights[corner] = place.cells[corner] == kNone ? 0.0f : weights.prod();
  }
  return place;
}

std::vector<int> SurfaceGrid::Around(int cell) const {
  std::vector<int> around;
  for (int x = -1; x <= 1; ++x) {
    for (int y = -1; y <= 1; ++y) {
      for (int z = -1; z <= 1; ++z) {
        const int other = IndexOf(cells_[cell] + Eigen::Array3i(x, y, z));
        if (other != kNone && other != cell) around.push_back(other);
      }
    }
  }
  return around;
}

}  // namespace drupe::dense
