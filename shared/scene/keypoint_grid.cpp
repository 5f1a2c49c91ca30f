#include "scene/keypoint_grid.h"

#include <algorithm>
#include <cmath>

namespace drupe {
namespace {

/// A grid finer than this would cost more memory than it saves time.
constexpr int kMaxCellsAlong = 2048;

std::vector<Eigen::Vector2f> PlacesOf(const Features& picture) {
  std::vector<Eigen::Vector2f> places;
  places.reserve(picture.size());
  for (const Keypoint& keypoint : picture.keypoints) places.emplace_back(keypoint.x, keypoint.y);
  return places;
}

}  // namespace

KeypointGrid::KeypointGrid(std::span<const Eigen::Vector2f> points, float cell) : cell_(cell) {
  if (points.empty()) return;
  Eigen::Vector2f high = points[0];
  origin_ = points[0];
  for (const Eigen::Vector2f& point : points) {
    origin_ = origin_.cwiseMin(point);
    high = high.cwiseMax(point);
  }
  cell_ = std::max(cell_, (high - origin_).maxCoeff() / kMaxCellsAlong);
  columns_ = static_cast<int>((high.x() - origin_.x()) / cell_) + 1;
  rows_ = static_cast<int>((high.y() - origin_.y()) / cell_) + 1;
  starts_.assign(static_cast<std::size_t>(columns_) * rows_ + 1, 0);
  const auto cell_of = [this](const Eigen::Vector2f& point) {
    return static_cast<std::size_t>(RowOf(point.y())) * columns_ + ColumnOf(point.x());
  };
  for (const Eigen::Vector2f& point : points) ++starts_[cell_of(point) + 1];
  for (std::size_t i = 1; i < starts_.size(); ++i) starts_[i] += starts_[i - 1];
  order_.resize(points.size());
  std::vector<std::uint32_t> next(starts_.begin(), starts_.end() - 1);
  for (std::size_t i = 0; i < points.size(); ++i) order_[next[cell_of(points[i])]++] = static_cast<std::uint32_t>(i);
}

KeypointGrid::KeypointGrid(const Features& picture, float cell) : KeypointGrid(PlacesOf(picture), cell) {}

int KeypointGrid::ColumnOf(float x) const {
  return static_cast<int>(std::clamp((x - origin_.x()) / cell_, 0.0f, static_cast<float>(columns_ - 1)));
}

int KeypointGrid::RowOf(float y) const {
  return static_cast<int>(std::clamp((y - origin_.y()) / cell_, 0.0f, static_cast<float>(rows_ - 1)));
}

}  // namespace drupe
