#include "capture/calibration/corner_refiner.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <vector>

namespace drupe {
namespace {

constexpr double kArmFrom = 0.12, kArmTo = 0.45;  // part of an edge that is measured, in squares from the corner
constexpr double kMinContrast = 20;               // grey levels between the squares
constexpr int kMaxReachPx = 6, kMinReachPx = 3;   // half length of a profile
constexpr double kMaxMovePx = 2;                  // farther, and the profile has found something else
constexpr std::size_t kMinProfiles = 3;           // on each arm

/// Bilinear; nothing outside the picture.
std::optional<double> Sample(const GrayImage& image, const Eigen::Vector2d& pixel) {
  const double floor_x = std::floor(pixel.x()), floor_y = std::floor(pixel.y());
  if (!(floor_x >= 0 && floor_y >= 0 && floor_x + 1 < image.width() && floor_y + 1 < image.height())) return {};
  const int x = static_cast<int>(floor_x), y = static_cast<int>(floor_y);
  const double u = pixel.x() - floor_x, v = pixel.y() - floor_y;
  const std::uint8_t *top = image.Row(y) + x, *bottom = image.Row(y + 1) + x;
  return (1 - v) * ((1 - u) * top[0] + u * top[1]) + v * ((1 - u) * bottom[0] + u * bottom[1]);
}

/// Mean of the middle half of the values.
double TrimmedMean(std::vector<double> values) {
  std::sort(values.begin(), values.end());
  const std::size_t skip = values.size() / 4;
  double sum = 0;
  for (std::size_t i = skip; i < values.size() - skip; ++i) sum += values[i];
  return sum / static_cast<double>(values.size() - 2 * skip);
}

/// One picture of the pattern, seen from the pattern's plane.
class Refiner {
 public:
  Refiner(const GrayImage& image, const PinholeCamera& camera, const Rigid3& cam_from_pattern)
      : image_(image), camera_(camera), cam_from_pattern_(cam_from_pattern) {}

  /// The pixel of the corner near `start_px`, whose edges run along the axes of the pattern's plane.
  /// Nothing else comes nearer than `clear_mm` to them.
  std::optional<Eigen::Vector2d> Refine(const Eigen::Vector2d& start_px, double square_mm, double clear_mm) const {
    Eigen::Vector2d corner = PlaneFromPixel(start_px);
    for (int iteration = 0; iteration < 2; ++iteration) {
      const auto along_x = EdgeOffset(corner, Eigen::Vector2d::UnitY(), Eigen::Vector2d::UnitX(), square_mm, clear_mm);
      const auto along_y = EdgeOffset(corner, Eigen::Vector2d::UnitX(), Eigen::Vector2d::UnitY(), square_mm, clear_mm);
      if (!along_x || !along_y) return {};
      corner += Eigen::Vector2d(*along_x, *along_y);
    }
    const auto pixel = PixelFromPlane(corner);
    if (!pixel || (*pixel - start_px).norm() > kMaxMovePx) return {};
    return pixel;
  }

 private:
  std::optional<Eigen::Vector2d> PixelFromPlane(const Eigen::Vector2d& mm) const {
    return camera_.Project(cam_from_pattern_ * Eigen::Vector3d(mm.x(), mm.y(), 0));
  }

  Eigen::Vector2d PlaneFromPixel(const Eigen::Vector2d& pixel) const {
    const Eigen::Vector2d xy = camera_.NormalisedFromPixel(pixel);
    const Eigen::Vector3d ray(xy.x(), xy.y(), 1);
    const Eigen::Matrix3d& r = cam_from_pattern_.rotation;
    const double depth = r.col(2).dot(cam_from_pattern_.translation) / r.col(2).dot(ray);
    return (r.transpose() * (depth * ray - cam_from_pattern_.translation)).head<2>();
  }

  /// Pixels that 1 mm along `direction` covers at `mm`.
  double PixelsPerMm(const Eigen::Vector2d& mm, const Eigen::Vector2d& direction) const {
    constexpr double kStepMm = 1e-3;
    const auto from = PixelFromPlane(mm), to = PixelFromPlane(mm + kStepMm * direction);
    return from && to ? (*to - *from).norm() / kStepMm : 0;
  }

  /// Where the edge crosses the profile centre + t * across, in mm from the centre.
  std::optional<double> CrossEdge(const Eigen::Vector2d& centre, const Eigen::Vector2d& across, double step_mm,
                                  int reach) const {
    std::array<double, 2 * kMaxReachPx + 1> values;
    const int count = 2 * reach + 1;
    double sum = 0;
    for (int i = 0; i < count; ++i) {
      const auto pixel = PixelFromPlane(centre + (i - reach) * step_mm * across);
      const auto value = pixel ? Sample(image_, *pixel) : std::nullopt;
      if (!value) return {};
      values[i] = *value;
      sum += *value;
    }
    const double before = (values[0] + values[1]) / 2, after = (values[count - 1] + values[count - 2]) / 2;
    if (std::abs(after - before) < kMinContrast) return {};
    const double samples_before = (after * count - sum) / (after - before);
    const double offset = samples_before - 0.5 - reach;
    if (!(std::abs(offset) < reach - 1.5)) return {};
    return offset * step_mm;
  }

  /// Mean offset across the edge through `corner` that runs along `along`: mean of its arms on both sides.
  std::optional<double> EdgeOffset(const Eigen::Vector2d& corner, const Eigen::Vector2d& along,
                                   const Eigen::Vector2d& across, double square_mm, double clear_mm) const {
    const double along_px = PixelsPerMm(corner, along), across_px = PixelsPerMm(corner, across);
    if (!(along_px > 0 && across_px > 0)) return {};
    if (clear_mm * across_px < kMinReachPx && clear_mm < 0.35 * square_mm) return {};
    const double most_px = std::min(0.35 * square_mm, clear_mm) * across_px;
    const int reach = std::clamp(static_cast<int>(most_px), kMinReachPx, kMaxReachPx);
    const int profiles = std::max(4, static_cast<int>((kArmTo - kArmFrom) * square_mm * along_px));
    double sum = 0;
    for (const double side : {-1.0, 1.0}) {
      std::vector<double> offsets;
      for (int i = 0; i < profiles; ++i) {
        const double distance = (kArmFrom + (kArmTo - kArmFrom) * (i + 0.5) / profiles) * square_mm;
        const auto offset = CrossEdge(corner + side * distance * along, across, 1 / across_px, reach);
        if (offset) offsets.push_back(*offset);
      }
      if (offsets.size() < kMinProfiles || 2 * offsets.size() < static_cast<std::size_t>(profiles)) return {};
      sum += TrimmedMean(std::move(offsets));
    }
    return sum / 2;
  }

  const GrayImage& image_;
  const PinholeCamera& camera_;
  const Rigid3& cam_from_pattern_;
};

}  // namespace

PatternCorners RefineCorners(const GrayImage& image, const Checkerboard& pattern, const PatternCorners& corners,
                             const PinholeCamera& camera, const Rigid3& cam_from_pattern) {
  const Refiner refiner(image, camera, cam_from_pattern);
  PatternCorners refined;
  for (std::size_t i = 0; i < corners.size(); ++i) {
    const auto pixel = refiner.Refine(corners.pixels[i], pattern.square_mm, pattern.ClearShare() * pattern.square_mm);
    if (!pixel) continue;
    refined.indices.push_back(corners.indices[i]);
    refined.pixels.push_back(*pixel);
  }
  return refined;
}

}  // namespace drupe
