#include "reconstruction/dense/surface_fit.h"

#include <Eigen/Cholesky>
#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <vector>

namespace drupe::dense {

namespace {

constexpr float kSigmaFloor = 0.02f;  ///< pixels of parallax: no patch is trusted further
constexpr float kSameSurface = 1.0f;  ///< pixels of parallax from the patch's plane, at the patch
constexpr float kBend = 0.15f;        ///< and this much more a pixel of distance
constexpr float kOutlierSigmas = 3.0f;
constexpr int kUnknowns = 6;

using Vector6 = Eigen::Matrix<float, kUnknowns, 1>;
using Matrix6 = Eigen::Matrix<float, kUnknowns, kUnknowns>;

struct Sample {
  Vector6 basis;  ///< 1, x, y, x^2, xy, y^2; x, y in units of the radius
  float value;    ///< pixels of parallax from the centre patch's w
  float weight;   ///< inverse variance times distance weight; 0: off the surface
};

struct Quadric {
  Vector6 coefficients = Vector6::Zero();
  float variance = 0;  ///< of the value at the centre
};

void CollectSamples(const PatchMap& map, int col, int row, int radius, std::vector<Sample>* samples) {
  samples->clear();
  const PatchCell& centre = map.At(col, row);
  const float inverse_radius = 1.0f / static_cast<float>(radius), per_unit = 1.0f / map.unit;
  for (int dr = -radius; dr <= radius; ++dr) {
    for (int dc = -radius; dc <= radius; ++dc) {
      if (!map.Holds(col + dc, row + dr)) continue;
      const PatchCell& cell = map.At(col + dc, row + dr);
      if (!cell.Filled()) continue;
      const float du = static_cast<float>(dc * map.csize), dv = static_cast<float>(dr * map.csize);
      const float off = (cell.w - centre.w - centre.wu * du - centre.wv * dv) * per_unit;
      if (std::abs(off) > kSameSurface + kBend * std::max(std::abs(du), std::abs(dv))) continue;
      const float x = static_cast<float>(dc) * inverse_radius, y = static_cast<float>(dr) * inverse_radius;
      const float distance_weight = std::exp(-1.0f * (x * x + y * y));
      Sample sample;
      sample.basis << 1, x, y, x * x, x * y, y * y;
      sample.value = (cell.w - centre.w) * per_unit;
      sample.weight = distance_weight / (cell.sigma * cell.sigma + kSigmaFloor * kSigmaFloor);
      samples->push_back(sample);
    }
  }
}

Quadric Fit(const std::vector<Sample>& samples) {
  Matrix6 normal = Matrix6::Identity() * 1e-3f;
  Vector6 right = Vector6::Zero();
  for (const Sample& sample : samples) {
    const Vector6 weighted = sample.weight * sample.basis;
    normal.noalias() += weighted * sample.basis.transpose();
    right += sample.value * weighted;
  }
  const Eigen::LLT<Matrix6> solver(normal);
  return {solver.solve(right), solver.solve(Vector6::Unit(0))[0]};
}

/// Weighted root mean square of the residuals.
float Spread(const std::vector<Sample>& samples, const Quadric& quadric) {
  float sum = 0, weights = 1e-20f;
  for (const Sample& sample : samples) {
    const float residual = sample.value - sample.basis.dot(quadric.coefficients);
    sum += sample.weight * residual * residual;
    weights += sample.weight;
  }
  return std::sqrt(sum / weights);
}

/// Drops samples off the quadric; the number of those that stay.
int DropOutliers(const Quadric& quadric, float limit, std::vector<Sample>* samples) {
  std::erase_if(*samples, [&](const Sample& sample) {
    return std::abs(sample.value - sample.basis.dot(quadric.coefficients)) > limit;
  });
  return static_cast<int>(samples->size());
}

PatchCell FitCell(const PatchMap& map, int col, int row, const SurfaceFitSettings& settings,
                  std::vector<Sample>* samples) {
  const int side = 2 * settings.radius + 1;
  const int least = std::max(kUnknowns + 3, static_cast<int>(settings.least_share * static_cast<float>(side * side)));
  CollectSamples(map, col, row, settings.radius, samples);
  if (static_cast<int>(samples->size()) < least) return PatchCell();
  Quadric quadric = Fit(*samples);
  const float limit = std::max(kOutlierSigmas * Spread(*samples, quadric), 0.05f);
  if (std::abs(quadric.coefficients[0]) > limit) return PatchCell();
  if (DropOutliers(quadric, limit, samples) < least) return PatchCell();
  quadric = Fit(*samples);
  PatchCell cell = map.At(col, row);
  const auto reach = static_cast<float>(settings.radius * map.csize);
  cell.bend = map.unit * (quadric.coefficients[3] + quadric.coefficients[5]) / (reach * reach);
  cell.w += map.unit * quadric.coefficients[0] - PlaneBias(cell, settings.window_px);
  cell.wu = map.unit * quadric.coefficients[1] / reach;
  cell.wv = map.unit * quadric.coefficients[2] / reach;
  const float overlap = std::max(1.0f, settings.window_px / static_cast<float>(map.csize));
  cell.sigma = std::sqrt(std::max(quadric.variance, 0.0f)) * overlap;
  return cell;
}

}  // namespace

float PlaneBias(const PatchCell& cell, float window_px) {
  return cell.bend * (window_px * window_px - 1) / 12;
}

PatchMap FitSurface(const PatchMap& map, const SurfaceFitSettings& settings, const std::function<bool()>& cancelled) {
  PatchMap fitted = map;
  std::vector<Sample> samples;
  for (int row = 0; row < map.rows && !(cancelled && cancelled()); ++row) {
    for (int col = 0; col < map.cols; ++col) {
      if (map.At(col, row).Filled()) fitted.At(col, row) = FitCell(map, col, row, settings, &samples);
    }
  }
  return fitted;
}

}  // namespace drupe::dense
