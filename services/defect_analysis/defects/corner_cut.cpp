#include "defect_analysis/defects/corner_cut.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "defect_analysis/defects/classify.h"

namespace drupe {
namespace {

using std::numbers::pi;
constexpr double kLeastReach = 0.25;     // mm: within less an outline turns as its noise has it
constexpr int kStepsPerReach = 8;        // of the outline, over the radius of the smallest spot
constexpr double kCorner = 0.7;          // rad by which the outline turns inwards within that reach to either side
constexpr std::size_t kMostCorners = 6;  // an outline with more has no form
constexpr double kPartRms = 0.05;        // of a part about its smooth form, relative to its radius
constexpr double kMostStretch = 1.5;     // length over width of a part
constexpr double kMostHidden = 0.6;      // of a part's area by the other

// An outline as points equally far apart.
struct EvenOutline {
  Polygon points;
  double step = 0;

  const Eigen::Vector2d& At(std::ptrdiff_t i) const {
    const auto count = static_cast<std::ptrdiff_t>(points.size());
    return points[static_cast<std::size_t>((i % count + count) % count)];
  }
};

EvenOutline SpreadEvenly(const Polygon& outline, double step) {
  EvenOutline even{.points = {}, .step = step};
  double next = 0;  // from the edge's first point to the next of the new ones
  for (std::size_t i = 0; i < outline.size(); ++i) {
    const Eigen::Vector2d way = outline[(i + 1) % outline.size()] - outline[i];
    const double length = way.norm();
    for (; next < length; next += step) even.points.push_back(outline[i] + next / length * way);
    next -= length;
  }
  return even;
}

// By how much the outline turns inwards at each point, rad: between the chords of `reach` points before and after it.
std::vector<double> InwardTurns(const EvenOutline& outline, int reach) {
  std::vector<double> turns;
  for (std::ptrdiff_t i = 0; i < static_cast<std::ptrdiff_t>(outline.points.size()); ++i) {
    const Eigen::Vector2d before = outline.At(i) - outline.At(i - reach), after = outline.At(i + reach) - outline.At(i);
    turns.push_back(-std::atan2(before.x() * after.y() - before.y() * after.x(), before.dot(after)));
  }
  return turns;
}

// The sharpest points of corners, ascending; none where there are too many for an outline with a form.
std::vector<std::size_t> InwardCorners(const EvenOutline& outline, int reach) {
  const std::vector<double> turns = InwardTurns(outline, reach);
  const auto count = static_cast<std::ptrdiff_t>(turns.size());
  std::vector<std::size_t> corners;
  for (std::ptrdiff_t i = 0; i < count; ++i) {
    const auto at = static_cast<std::size_t>(i);
    bool sharpest = turns[at] > kCorner;
    for (std::ptrdiff_t k = -reach; k <= reach && sharpest; ++k) {
      const double other = turns[static_cast<std::size_t>((i + k + count) % count)];
      sharpest = k < 0 ? turns[at] > other : turns[at] >= other;
    }
    if (sharpest) corners.push_back(at);
  }
  if (corners.size() > kMostCorners) corners.clear();
  return corners;
}

// The part of the outline between two corners, completed.
std::optional<CompletedOutline> CompletePart(const EvenOutline& outline, std::size_t from, std::size_t to) {
  if (to <= from) to += outline.points.size();
  std::vector<Eigen::Vector2d> seen;
  for (std::size_t i = from; i <= to; ++i) seen.push_back(outline.At(static_cast<std::ptrdiff_t>(i)));
  return CompleteOutline(seen);
}

bool IsRoundSpot(const std::optional<CompletedOutline>& part, double min_area) {
  if (!part || part->rms > kPartRms) return false;
  const double area = SignedArea(part->polygon);
  return area >= min_area && ShapeOf(part->polygon, area, 0).elongation <= kMostStretch;
}

// Whether most of one part lies within the other: then both are arcs of one spot with a bay on either side.
bool AreOneSpot(const Polygon& first, const Polygon& second) {
  return CommonArea(first, second) > kMostHidden * std::min(SignedArea(first), SignedArea(second));
}

}  // namespace

std::optional<std::array<CompletedOutline, 2>> CutAtCorners(const Polygon& outline, double min_area) {
  const double reach = std::max(kLeastReach, std::sqrt(min_area / pi));
  const EvenOutline even = SpreadEvenly(outline, reach / kStepsPerReach);
  const std::vector<std::size_t> corners = InwardCorners(even, kStepsPerReach);
  std::optional<std::array<CompletedOutline, 2>> best;
  double least = 2 * kPartRms;
  for (std::size_t a = 0; a < corners.size(); ++a) {
    for (std::size_t b = a + 1; b < corners.size(); ++b) {
      auto first = CompletePart(even, corners[a], corners[b]), second = CompletePart(even, corners[b], corners[a]);
      if (!IsRoundSpot(first, min_area) || !IsRoundSpot(second, min_area)) continue;
      if (first->rms + second->rms >= least || AreOneSpot(first->polygon, second->polygon)) continue;
      least = first->rms + second->rms;
      best = {std::move(*first), std::move(*second)};
    }
  }
  return best;
}

}  // namespace drupe
