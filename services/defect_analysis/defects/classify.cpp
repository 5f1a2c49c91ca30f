#include "defect_analysis/defects/classify.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace drupe {
namespace {

constexpr double kThreadlike = 8;      // length over width from which half the depth tells a crack: no scar is so thin
constexpr double kFullLightness = 60;  // L of the skin for which a threshold of lightness is meant as it stands
constexpr double kSoot = 30;           // L below which nothing is cork or bare flesh, as a scar is
constexpr double kNotPaler = 6;        // step in L from the skin up to which a defect looks no paler

// How surely `value` is on its side of `threshold`: 0.5 on it, 0.95 a factor of e^(1/2) away.
double Sureness(double value, double threshold) {
  const double margin = std::abs(std::log(std::max(1e-6, value) / threshold));
  return 1 / (1 + std::exp(-6 * margin));
}

double SurenessOfDifference(double value, double threshold, double scale) {
  return 1 / (1 + std::exp(-3 * std::abs(value - threshold) / scale));
}

// Whether a defect lies deeper than `least` beyond doubt.
bool IsSunk(const DefectShape& shape, double least) {
  constexpr double kBeyondDoubt = 3;  // standard uncertainties
  return shape.depth_uncertainty_mm > 0 && shape.depth_mm > least &&
         shape.depth_mm > kBeyondDoubt * shape.depth_uncertainty_mm;
}

}  // namespace

DefectShape ShapeOf(const Polygon& polygon, double area_mm2, double lightness_step) {
  const Eigen::Vector2d centre = Centroid(polygon);
  Eigen::Matrix2d moment = Eigen::Matrix2d::Zero();
  double area = 0;
  for (std::size_t i = 0; i < polygon.size(); ++i) {
    const Eigen::Vector2d a = polygon[i] - centre;
    const Eigen::Vector2d b = polygon[(i + 1) % polygon.size()] - centre;
    const double cross = a.x() * b.y() - a.y() * b.x();
    moment += cross * (a * a.transpose() + b * b.transpose() + (a + b) * (a + b).transpose()) / 24;
    area += cross / 2;
  }
  moment /= area;
  // The moments' eigenvalues in closed form; four times their root is a full axis of the ellipse.
  const double mean = moment.trace() / 2;
  const double spread = std::sqrt(std::max(0.0, mean * mean - moment.determinant()));
  const double length = 4 * std::sqrt(mean + spread);
  const double width = 4 * std::sqrt(std::max(1e-12, mean - spread));
  DefectShape shape;
  shape.area_mm2 = area_mm2;
  shape.lightness_step = lightness_step;
  shape.elongation = length / width;
  shape.length_mm = length;
  const Eigen::Vector2d along(moment(0, 1), mean + spread - moment(0, 0));  // an eigenvector, unless it vanishes
  if (along.norm() > 1e-12) {
    shape.axis = along.normalized();
  } else if (moment(1, 1) > moment(0, 0)) {
    shape.axis = Eigen::Vector2d::UnitY();
  }
  shape.width_mm = area_mm2 / (length * std::numbers::pi / 4);
  return shape;
}

Classification Classify(const DefectShape& shape, const ClassOptions& options) {
  const double elongated = Sureness(shape.elongation, options.elongated_min);
  if (shape.elongation < options.elongated_min) {
    const bool decay = shape.area_mm2 >= options.decay_min_area_mm2;
    if (!decay && 2 * shape.area_mm2 >= options.decay_min_area_mm2 && IsSunk(shape, options.decay_min_depth_mm)) {
      return {DefectClass::kDecay, 0.6};
    }
    const double size = Sureness(shape.area_mm2, options.decay_min_area_mm2);
    return {decay ? DefectClass::kDecay : DefectClass::kRainSpot, std::min(elongated, size)};
  }
  const bool narrow = shape.width_mm < options.crack_max_width_mm;
  // On dark skin a dark crack makes a smaller step.
  const double darkest = options.crack_max_lightness * std::clamp(shape.skin_lightness / kFullLightness, 0.0, 1.0);
  const double least_depth = options.crack_min_depth_mm * (shape.elongation < kThreadlike ? 1 : 0.5);
  // On skin as dark as itself it makes none, but it is as dark as ever.
  const double lightness = shape.skin_lightness + shape.lightness_step;
  const bool sooty = lightness < kSoot && shape.lightness_step < kNotPaler;
  const bool dark = shape.lightness_step < darkest || sooty || IsSunk(shape, least_depth);
  const double width = Sureness(shape.width_mm, options.crack_max_width_mm);
  const double darkness = std::max(SurenessOfDifference(shape.lightness_step, darkest, 10),
                                   sooty ? SurenessOfDifference(lightness, kSoot, 10) : 0);
  if (narrow && dark) return {DefectClass::kCrack, std::min({elongated, width, darkness})};
  const double not_crack = std::max(narrow ? 0.5 : width, dark ? 0.5 : darkness);
  return {DefectClass::kScar, std::min(elongated, not_crack)};
}

}  // namespace drupe
