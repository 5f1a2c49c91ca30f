#include "reconstruction/board/marker_refiner.h"

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <vector>

namespace drupe {
namespace {

using Corners = std::array<Eigen::Vector2d, 4>;

constexpr double kProfileStepPx = 0.5;   // finer than a pixel, so that the sum approximates the integral
constexpr double kPlateauReachPx = 3.0;  // blur of a focused lens has faded this far from an edge
constexpr double kMinContrast = 24.0;    // grey levels between border and paper
constexpr double kSideMargin = 0.1;      // share of a side next to a corner, where the other side blurs in
constexpr int kMinEdges = 6;             // edges that a line needs
constexpr double kMinEdgeShare = 0.6;    // of the profiles of a side must agree with its line
constexpr double kOutlierPx = 0.5;       // farther from the line: a speck on the paper, a neighbour, noise
constexpr int kMaxProfiles = 96;

/// Bilinear value; the caller keeps 0 <= x <= width - 2.
double Sample(const GrayImage& image, double x, double y) {
  const int column = static_cast<int>(x), row = static_cast<int>(y);
  const double fx = x - column, fy = y - row;
  const std::uint8_t* top = image.Row(row) + column;
  const std::uint8_t* bottom = image.Row(row + 1) + column;
  return (top[0] * (1 - fx) + top[1] * fx) * (1 - fy) + (bottom[0] * (1 - fx) + bottom[1] * fx) * fy;
}

bool IsInside(const GrayImage& image, const Eigen::Vector2d& p) {
  return p.x() >= 0 && p.y() >= 0 && p.x() < image.width() - 1 && p.y() < image.height() - 1;
}

/// Middle of the steepest rise of a profile.
std::size_t SteepestRise(const std::vector<double>& profile) {
  std::size_t best = 1;
  for (std::size_t i = 1; i + 1 < profile.size(); ++i) {
    if (profile[i + 1] - profile[i - 1] > profile[best + 1] - profile[best - 1]) best = i;
  }
  return best;
}

struct WeightedLine {
  Eigen::Vector2d centre;
  Eigen::Vector2d direction;
};

/// Total least squares over the points of weight 1.
WeightedLine FitLine(const std::vector<Eigen::Vector2d>& points, const std::vector<std::uint8_t>& used) {
  Eigen::Vector2d mean = Eigen::Vector2d::Zero();
  double count = 0;
  for (std::size_t i = 0; i < points.size(); ++i) {
    if (used[i]) mean += points[i], ++count;
  }
  mean /= count;
  Eigen::Matrix2d scatter = Eigen::Matrix2d::Zero();
  for (std::size_t i = 0; i < points.size(); ++i) {
    if (used[i]) scatter += (points[i] - mean) * (points[i] - mean).transpose();
  }
  const double angle = 0.5 * std::atan2(2 * scatter(0, 1), scatter(0, 0) - scatter(1, 1));
  return {mean, {std::cos(angle), std::sin(angle)}};
}

double Distance(const WeightedLine& line, const Eigen::Vector2d& p) {
  const Eigen::Vector2d d = p - line.centre;
  return line.direction.x() * d.y() - line.direction.y() * d.x();
}

/// Marks the points within `tolerance` of the line through the best of a fixed set of pairs: exact, small, no
/// randomness.
std::vector<std::uint8_t> ConsensusLine(const std::vector<Eigen::Vector2d>& points, double tolerance) {
  const std::size_t n = points.size(), half = n / 2;
  std::vector<std::uint8_t> best(n, 0), now(n, 0);
  int best_count = -1;
  for (std::size_t i = 0; i < half; ++i) {
    const WeightedLine line{points[i], (points[i + half] - points[i]).normalized()};
    int count = 0;
    for (std::size_t k = 0; k < n; ++k) count += now[k] = std::abs(Distance(line, points[k])) <= tolerance;
    if (count > best_count) best_count = count, best = now;
  }
  return best;
}

}  // namespace

std::optional<double> MarkerRefiner::FindEdge(const Eigen::Vector2d& centre, const Eigen::Vector2d& direction,
                                              const Reach& reach) const {
  const int window = std::max(2, static_cast<int>(std::lround(reach.plateau_px / kProfileStepPx)));
  const int half = window + static_cast<int>(std::ceil(reach.search_px / kProfileStepPx));
  const Eigen::Vector2d step = direction * kProfileStepPx;
  if (!IsInside(image_, centre - half * step) || !IsInside(image_, centre + half * step)) return std::nullopt;
  thread_local std::vector<double> profile;
  profile.resize(2 * half + 1);
  for (int i = -half; i <= half; ++i) {
    const Eigen::Vector2d p = centre + i * step;
    profile[i + half] = Sample(image_, p.x(), p.y());
  }
  const int middle = static_cast<int>(SteepestRise(profile));
  if (middle - window < 0 || middle + window > 2 * half) return std::nullopt;
  const double* p = profile.data() + middle;
  const double dark = 0.5 * (p[-window] + p[-window + 1]), bright = 0.5 * (p[window] + p[window - 1]);
  if (bright - dark < kMinContrast) return std::nullopt;
  double area = 0;  // trapezoids, in units of a full step from dark to bright
  for (int i = -window; i <= window; ++i) area += (i == -window || i == window ? 0.5 : 1.0) * (p[i] - dark);
  const double bright_length = area / (bright - dark);
  return (middle - half + window - bright_length) * kProfileStepPx;
}

std::optional<MarkerRefiner::Line> MarkerRefiner::MeasureSide(const Eigen::Vector2d& from, const Eigen::Vector2d& to,
                                                              const Eigen::Vector2d& outward,
                                                              const Reach& reach) const {
  const double length = (to - from).norm();
  const int profiles = std::clamp(static_cast<int>(length * (1 - 2 * kSideMargin)), kMinEdges, kMaxProfiles);
  std::vector<Eigen::Vector2d> edges;
  edges.reserve(profiles);
  for (int i = 0; i < profiles; ++i) {
    const double t = kSideMargin + (1 - 2 * kSideMargin) * (i + 0.5) / profiles;
    const Eigen::Vector2d centre = from + t * (to - from);
    if (const auto offset = FindEdge(centre, outward, reach)) {
      edges.push_back(camera_.NormalisedFromPixel(centre + *offset * outward));
    }
  }
  if (static_cast<int>(edges.size()) < kMinEdges) return std::nullopt;
  const double tolerance = kOutlierPx / std::max(camera_.fx, camera_.fy);
  std::vector<std::uint8_t> used = ConsensusLine(edges, tolerance);
  WeightedLine line{};
  for (int round = 0; round < 2; ++round) {
    if (std::count(used.begin(), used.end(), 1) < std::max<double>(kMinEdges, kMinEdgeShare * profiles)) {
      return std::nullopt;
    }
    line = FitLine(edges, used);
    for (std::size_t k = 0; k < edges.size(); ++k) used[k] = std::abs(Distance(line, edges[k])) <= tolerance;
  }
  const Eigen::Vector2d normal(-line.direction.y(), line.direction.x());
  return Line{normal, normal.dot(line.centre)};
}

std::optional<Corners> MarkerRefiner::RefineOnce(const Corners& corners, const Reach& reach) const {
  const Eigen::Vector2d middle = 0.25 * (corners[0] + corners[1] + corners[2] + corners[3]);
  std::array<Line, 4> lines;  // line k joins corner k and corner k + 1
  for (int k = 0; k < 4; ++k) {
    const Eigen::Vector2d &from = corners[k], &to = corners[(k + 1) % 4];
    Eigen::Vector2d outward = Eigen::Vector2d(to.y() - from.y(), from.x() - to.x()).normalized();
    if (outward.dot(from - middle) < 0) outward = -outward;
    const auto line = MeasureSide(from, to, outward, reach);
    if (!line) return std::nullopt;
    lines[k] = *line;
  }
  Corners refined;
  for (int k = 0; k < 4; ++k) {
    Eigen::Matrix2d system;
    const Line &before = lines[(k + 3) % 4], &after = lines[k];
    system << before.normal.transpose(), after.normal.transpose();
    if (std::abs(system.determinant()) < 0.05) return std::nullopt;  // sides nearly parallel: seen edge on
    refined[k] = camera_.PixelFromNormalised(system.inverse() * Eigen::Vector2d(before.offset, after.offset));
  }
  return refined;
}

std::optional<Corners> MarkerRefiner::Refine(const Corners& corners, double uncertainty_px) const {
  // The border is one cell wide; a profile that reaches farther meets the marker's pattern.
  double shortest = 1e9;
  for (int k = 0; k < 4; ++k) {
    const Eigen::Vector2d side = corners[(k + 1) % 4] - corners[k], next = corners[(k + 2) % 4] - corners[(k + 1) % 4];
    shortest = std::min(shortest, std::abs(side.x() * next.y() - side.y() * next.x()) / side.norm());
  }
  const double border = shortest / cells_a_side_;
  const double plateau = std::min(kPlateauReachPx, 0.7 * border);
  const auto coarse = RefineOnce(corners, {std::min(uncertainty_px, std::max(1.0, 0.7 * border)), plateau});
  if (!coarse) return std::nullopt;
  const double moved_limit = 2.5 * uncertainty_px + 1.0;
  const auto fine = RefineOnce(*coarse, {std::min(1.0, 0.5 * border), plateau});
  if (!fine) return std::nullopt;
  for (int k = 0; k < 4; ++k) {
    if (((*fine)[k] - corners[k]).norm() > moved_limit) return std::nullopt;
  }
  return fine;
}

}  // namespace drupe
