#include "reconstruction/dense/silhouette.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace drupe::dense {

namespace {

constexpr int kBlocksAcross = 128;   ///< of a silhouette, at least
constexpr double kFullBlock = 0.95;  ///< share of a background block's samples
constexpr int kViewsAsked = 12;
constexpr int kLeastOutside = 2;  ///< views that must place a point outside, and the share of them
constexpr double kLeastOutsideShare = 0.15;

/// Blocks reached from the border over marked blocks, in steps to the four sides.
std::vector<std::uint8_t> FloodFromBorder(const std::vector<std::uint8_t>& marked, int cols, int rows) {
  std::vector<std::uint8_t> reached(marked.size(), 0);
  std::vector<std::pair<int, int>> open;
  const auto visit = [&](int col, int row) {
    if (col < 0 || row < 0 || col >= cols || row >= rows) return;
    const std::size_t at = static_cast<std::size_t>(row) * cols + col;
    if (!marked[at] || reached[at]) return;
    reached[at] = 1;
    open.emplace_back(col, row);
  };
  for (int col = 0; col < cols; ++col) {
    visit(col, 0);
    visit(col, rows - 1);
  }
  for (int row = 0; row < rows; ++row) {
    visit(0, row);
    visit(cols - 1, row);
  }
  while (!open.empty()) {
    const auto [col, row] = open.back();
    open.pop_back();
    visit(col + 1, row);
    visit(col - 1, row);
    visit(col, row + 1);
    visit(col, row - 1);
  }
  return reached;
}

/// True when nearly all of a block's samples, four by four at most, have a background colour.
bool IsBackgroundBlock(const RgbImage& picture, const BackgroundColours& colours, int x0, int y0, int block) {
  const int step = std::max(1, block / 4);
  int samples = 0, background = 0;
  for (int y = y0; y < std::min(y0 + block, picture.height()); y += step) {
    for (int x = x0; x < std::min(x0 + block, picture.width()); x += step) {
      ++samples;
      background += colours.Contains(picture.Row(y) + 3 * x) ? 1 : 0;
    }
  }
  return background >= kFullBlock * samples;
}

}  // namespace

Silhouette::Silhouette(const RgbImage& picture, const BackgroundColours& colours) {
  if (colours.Empty()) return;
  block_ = std::max(2, std::max(picture.width(), picture.height()) / kBlocksAcross);
  cols_ = (picture.width() + block_ - 1) / block_;
  rows_ = (picture.height() + block_ - 1) / block_;
  std::vector<std::uint8_t> marked;
  for (int row = 0; row < rows_; ++row) {
    for (int col = 0; col < cols_; ++col) {
      marked.push_back(IsBackgroundBlock(picture, colours, col * block_, row * block_, block_) ? 1 : 0);
    }
  }
  background_ = FloodFromBorder(marked, cols_, rows_);
}

bool Silhouette::IsBackground(double u, double v) const {
  const double col = std::floor((u + 0.5) / block_), row = std::floor((v + 0.5) / block_);
  if (!(col >= 0 && row >= 0 && col < cols_ && row < rows_)) return false;
  return background_[static_cast<std::size_t>(row) * cols_ + static_cast<std::size_t>(col)] != 0;
}

std::vector<Silhouette> FindSilhouettes(const SparseModel& model, const RegionOfInterest& region,
                                        const std::vector<DenseView>& views) {
  const BackgroundColours colours = BackgroundColours::Learn(model, region, views);
  std::vector<Silhouette> silhouettes;
  for (const DenseView& view : views) silhouettes.emplace_back(view.rgb, colours);
  return silhouettes;
}

bool IsOutsideHull(const std::vector<DenseView>& views, const std::vector<Silhouette>& silhouettes,
                   const Eigen::Vector3d& point) {
  const std::size_t step = std::max<std::size_t>(1, views.size() / kViewsAsked);
  int asked = 0, outside = 0;
  for (std::size_t i = 0; i < views.size(); i += step) {
    const Eigen::Vector3d in_cam = views[i].cam_from_world * point;
    if (in_cam.z() <= 0) continue;
    const Eigen::Vector2d pixel = views[i].camera.Pixel(in_cam);
    ++asked;
    outside += silhouettes[i].IsBackground(pixel.x(), pixel.y()) ? 1 : 0;
  }
  return outside >= kLeastOutside && outside >= kLeastOutsideShare * asked;
}

}  // namespace drupe::dense
