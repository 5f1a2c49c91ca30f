#include "reconstruction/dense/looks.h"

#include <algorithm>
#include <limits>

#include "reconstruction/dense/visibility.h"

namespace drupe::dense {

namespace {

constexpr double kFrontalShare = 0.75;  ///< a view's score against the best: beyond it the skin is seen aslant
constexpr double kLeastShare = 0.4;     ///< the same where few see it from the front
constexpr double kAnyShare = std::numeric_limits<double>::infinity();
constexpr int kEnoughLooks = 4;
constexpr float kSightTolerance = 2.0f;  ///< pixels of parallax, for visibility
constexpr double kBeside = 0.02;         ///< of the distance: what lies by so much nearer is another surface
constexpr float kSaturated = 252.0f;

/// Bilinear; false outside the picture.
bool SampleRgb(const DenseView& view, const Eigen::Vector2d& pixel, Eigen::Array3f* rgb) {
  const RgbImage& image = view.rgb;
  if (!(pixel.x() >= 0 && pixel.y() >= 0 && pixel.x() < image.width() - 1 && pixel.y() < image.height() - 1)) {
    return false;
  }
  const int x = static_cast<int>(pixel.x()), y = static_cast<int>(pixel.y());
  const auto fx = static_cast<float>(pixel.x() - x), fy = static_cast<float>(pixel.y() - y);
  const std::uint8_t *top = image.Row(y) + 3 * x, *bottom = image.Row(y + 1) + 3 * x;
  for (int c = 0; c < 3; ++c) {
    const float upper = static_cast<float>(top[c]) + fx * static_cast<float>(top[c + 3] - top[c]);
    const float lower = static_cast<float>(bottom[c]) + fx * static_cast<float>(bottom[c + 3] - bottom[c]);
    (*rgb)[c] = upper + fy * (lower - upper);
  }
  return true;
}

/// Of every cell, the largest 1/z in the 3 x 3 cells about it.
std::vector<float> NearestAbout(const PatchMap& map) {
  std::vector<float> nearest(map.cells.size(), 0.0f);
  for (int row = 0; row < map.rows; ++row) {
    for (int col = 0; col < map.cols; ++col) {
      const PatchCell& cell = map.At(col, row);
      if (!cell.Filled()) continue;
      for (int y = std::max(row - 1, 0); y <= std::min(row + 1, map.rows - 1); ++y) {
        for (int x = std::max(col - 1, 0); x <= std::min(col + 1, map.cols - 1); ++x) {
          float& value = nearest[static_cast<std::size_t>(y) * map.cols + x];
          value = std::max(value, cell.w);
        }
      }
    }
  }
  return nearest;
}

}  // namespace

LookCollector::LookCollector(const LevelContext& context, const std::vector<PatchMap>& maps)
    : context_(context), maps_(maps) {
  for (const PatchMap& map : maps) nearest_.push_back(NearestAbout(map));
}

bool LookCollector::IsHidden(int view, const SurfaceElement& element) const {
  const PatchMap& map = maps_[view];
  if (LookAt(context_, view, map, element, kSightTolerance) == Sight::kOccluded) return true;
  const Eigen::Vector3d in_cam = context_.scene->views[view].cam_from_world * element.position;
  const Eigen::Vector2d pixel = context_.cameras[view].Pixel(in_cam);
  const int col = map.CellOf(pixel.x()), row = map.CellOf(pixel.y());
  if (in_cam.z() <= 0 || !map.Holds(col, row)) return false;
  return nearest_[view][static_cast<std::size_t>(row) * map.cols + col] * in_cam.z() > 1 + kBeside;
}

void LookCollector::Add(int view, const SurfaceElement& element, double share, Looks* looks) const {
  const DenseView& camera_view = context_.scene->views[view];
  const Eigen::Vector3d in_cam = camera_view.cam_from_world * element.position;
  Eigen::Array3f rgb;
  if (in_cam.z() <= 0 || !SampleRgb(camera_view, camera_view.camera.Pixel(in_cam), &rgb)) return;
  if (rgb.maxCoeff() > kSaturated) return;
  looks->items[looks->count++] = {view, static_cast<float>(std::min(share, 1.0)), (rgb + 1.0f).log()};
}

void LookCollector::AddNeighbours(int owner, const SurfaceElement& element, double best, double least, double below,
                                  Looks* looks) const {
  for (const int neighbour : context_.scene->neighbours[owner]) {
    const double share = ViewScore(*context_.scene, neighbour, element) / best;
    if (share < least || share >= below || looks->count == kMaxLooks || IsHidden(neighbour, element)) continue;
    Add(neighbour, element, share, looks);
  }
}

Looks LookCollector::Collect(int owner, bool matched, const SurfaceElement& element) const {
  Looks looks;
  const double best = ViewScore(*context_.scene, owner, element);
  if (matched && !IsHidden(owner, element)) Add(owner, element, 1.0, &looks);
  AddNeighbours(owner, element, best, kFrontalShare, kAnyShare, &looks);
  if (looks.count < kEnoughLooks) AddNeighbours(owner, element, best, kLeastShare, kFrontalShare, &looks);
  if (looks.count == 0) Add(owner, element, 1.0, &looks);
  return looks;
}

}  // namespace drupe::dense
