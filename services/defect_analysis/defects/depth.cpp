#include "defect_analysis/defects/depth.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "geometry/robust.h"

namespace drupe {
namespace {

constexpr double kRingFrom = 0.4, kRingTo = 2.2;  // mm outside the outline
constexpr double kCoreShare = 0.4;                // of the largest depth inside the outline, from which points count
constexpr int kSectors = 12;
constexpr std::size_t kMostRing = 4000;
constexpr std::size_t kDepthOutlineSample = 160;
constexpr std::size_t kLeastRing = 40;
constexpr std::size_t kLeastCore = 5;

using Quadratic = Eigen::Matrix<double, 6, 1>;

Quadratic RowOf(const Eigen::Vector2d& p) {
  Quadratic row;
  row << 1, p.x(), p.y(), p.x() * p.x(), p.x() * p.y(), p.y() * p.y();
  return row;
}

struct Height {
  Eigen::Vector2d flat;
  double height = 0;
  double outside = 0;  // distance from the outline, negative inside
};

double DistanceOutside(const Polygon& outline, const Eigen::Vector2d& p) {
  bool inside = false;
  double nearest = 1e18;
  const std::size_t stride = std::max<std::size_t>(1, outline.size() / kDepthOutlineSample);
  for (std::size_t i = 0; i < outline.size(); i += stride) nearest = std::min(nearest, (outline[i] - p).squaredNorm());
  for (std::size_t i = 0, j = outline.size() - 1; i < outline.size(); j = i++) {
    const Eigen::Vector2d &a = outline[i], &b = outline[j];
    if ((a.y() > p.y()) == (b.y() > p.y())) continue;
    if (p.x() < a.x() + (p.y() - a.y()) / (b.y() - a.y()) * (b.x() - a.x())) inside = !inside;
  }
  return inside ? -std::sqrt(nearest) : std::sqrt(nearest);
}

// The points in the outline and in the ring about it; every n-th of a dense cloud.
std::vector<Height> HeightsAbout(const FruitCloud& fruit, const SkinMap& map, const SkinChart& chart,
                                 const Polygon& outline) {
  Eigen::Vector2d low = outline.front(), high = low;
  for (const Eigen::Vector2d& p : outline) {
    low = low.cwiseMin(p);
    high = high.cwiseMax(p);
  }
  low.array() -= kRingTo;
  high.array() += kRingTo;
  std::vector<std::int32_t> cells;
  const double step = 0.7 * map.CellSize();
  for (double y = low.y(); y <= high.y(); y += step) {
    for (double x = low.x(); x <= high.x(); x += step) {
      cells.push_back(map.map().CellOf(chart.DirectionFromFlat({x, y}).cast<float>()));
    }
  }
  std::sort(cells.begin(), cells.end());
  cells.erase(std::unique(cells.begin(), cells.end()), cells.end());
  std::vector<std::uint32_t> points;
  for (const std::int32_t cell : cells) {
    for (const std::uint32_t i : map.PointsOf(cell)) {
      if (i < fruit.size()) points.push_back(i);  // not a bridged gap's
    }
  }
  const std::size_t stride = 1 + points.size() / (2 * kMostRing);
  std::vector<Height> heights;
  for (std::size_t k = 0; k < points.size(); k += stride) {
    const Eigen::Vector3d offset = fruit.offsets[points[k]].cast<double>();
    const Eigen::Vector2d flat = chart.FlatFromDirection(offset);
    const double outside = DistanceOutside(outline, flat);
    if (outside < kRingTo) heights.push_back({flat, offset.dot(chart.direction()), outside});
  }
  return heights;
}

Quadratic FitSkin(const std::vector<Height>& ring) {
  Quadratic skin = Quadratic::Zero();
  std::vector<double> weights(ring.size(), 1);
  for (int iteration = 0; iteration < 4; ++iteration) {
    Eigen::Matrix<double, 6, 6> normal = 1e-9 * Eigen::Matrix<double, 6, 6>::Identity();
    Quadratic rhs = Quadratic::Zero();
    for (std::size_t i = 0; i < ring.size(); ++i) {
      const Quadratic row = RowOf(ring[i].flat);
      normal += weights[i] * row * row.transpose();
      rhs += weights[i] * ring[i].height * row;
    }
    skin = normal.ldlt().solve(rhs);
    std::vector<double> residuals;
    for (const Height& h : ring) residuals.push_back(h.height - RowOf(h.flat).dot(skin));
    const double scale = std::max(1e-4, RobustSigma(residuals));
    for (std::size_t i = 0; i < ring.size(); ++i) weights[i] = TukeyWeight(residuals[i] / scale);
  }
  return skin;
}

// Standard deviation of the sectors' mean residuals about the middle of the outline.
double SectorScatter(const std::vector<Height>& ring, const Quadratic& skin, const Eigen::Vector2d& middle) {
  std::array<double, kSectors> sums{}, counts{};
  for (const Height& h : ring) {
    const Eigen::Vector2d offset = h.flat - middle;
    const double turn = std::atan2(offset.y(), offset.x()) / (2 * std::numbers::pi) + 0.5;
    const auto sector = static_cast<std::size_t>(std::clamp(static_cast<int>(turn * kSectors), 0, kSectors - 1));
    sums[sector] += h.height - RowOf(h.flat).dot(skin);
    counts[sector] += 1;
  }
  double squares = 0;
  int used = 0;
  for (std::size_t k = 0; k < kSectors; ++k) {
    if (counts[k] == 0) continue;
    squares += sums[k] / counts[k] * (sums[k] / counts[k]);
    ++used;
  }
  return used > 6 ? std::sqrt(squares / (used - 6)) : std::sqrt(squares);  // the fit took six degrees of freedom
}

}  // namespace

DefectDepth MeasureDepth(const FruitCloud& fruit, const SkinMap& map, const SkinChart& chart, const Polygon& outline) {
  std::vector<Height> ring, inside;
  double deepest = 0;
  for (const Height& h : HeightsAbout(fruit, map, chart, outline)) {
    if (h.outside > kRingFrom) ring.push_back(h);
    if (h.outside >= 0) continue;
    inside.push_back(h);
    deepest = std::max(deepest, -h.outside);
  }
  std::erase_if(inside, [&](const Height& h) { return -h.outside < kCoreShare * deepest; });
  if (ring.size() < kLeastRing || inside.size() < kLeastCore) return {};
  const Quadratic skin = FitSkin(ring);
  std::vector<double> depths;
  for (const Height& h : inside) depths.push_back(RowOf(h.flat).dot(skin) - h.height);
  DefectDepth depth{.mm = Median(depths), .uncertainty_mm = 0};
  for (double& d : depths) d -= depth.mm;
  const double own = 1.25 * RobustSigma(depths) / std::sqrt(static_cast<double>(depths.size()));  // of a median
  depth.uncertainty_mm = std::hypot(SectorScatter(ring, skin, Centroid(outline)), own);
  return depth;
}

}  // namespace drupe
