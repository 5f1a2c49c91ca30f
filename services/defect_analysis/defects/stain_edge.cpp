#include "defect_analysis/defects/stain_edge.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "defect_analysis/defects/classify.h"
#include "defect_analysis/defects/contour.h"
#include "defect_analysis/defects/round_outline.h"

namespace drupe {
namespace {

constexpr int kEdgeSectors = 8;
constexpr int kMostSoft = 1;                 // sectors that may lack the edge
constexpr double kRoundStainRms = 0.1;       // of the outline about its smooth form, relative to its radius
constexpr double kRoundStretch = 1.8;        // length over width
constexpr double kElsewhere = 0.2;           // of the area, in further pieces
constexpr double kNear = 0.15, kFar = 0.35;  // mm from the outline where the edge must have ended
constexpr double kDeepest = 0.5;             // of the radius: not deeper inside than this
constexpr double kInside = 0.7, kOutside = 0.3;
constexpr int kEdgeSamples = 3;
constexpr double kLeastSlopeShare = 0.5;  // of the median, for the twentieth least steep part of an outline

struct SectorLevels {
  std::array<double, kEdgeSectors> inside{}, outside{}, count{};
};

SectorLevels LevelsBeside(const TransitionField& field, const Polygon& outline) {
  const Eigen::Vector2d middle = Centroid(outline);
  SectorLevels levels;
  for (const Eigen::Vector2d& p : outline) {
    const Eigen::Vector2d offset = p - middle;
    const double radius = offset.norm();
    if (radius < field.step) continue;
    const double turn = std::atan2(offset.y(), offset.x()) / (2 * std::numbers::pi) + 0.5;
    const auto sector =
        static_cast<std::size_t>(std::clamp(static_cast<int>(turn * kEdgeSectors), 0, kEdgeSectors - 1));
    for (int k = 0; k < kEdgeSamples; ++k) {
      const double at = kNear + (kFar - kNear) * k / (kEdgeSamples - 1);
      const Eigen::Vector2d inner = p - std::min(at, kDeepest * radius) / radius * offset;
      levels.inside[sector] += field.ValueAt(field.full_level, inner) / kEdgeSamples;
      levels.outside[sector] += field.ValueAt(field.full_level, p + at / radius * offset) / kEdgeSamples;
    }
    levels.count[sector] += 1;
  }
  return levels;
}

// How steeply the level falls along the largest outline, per mm, ascending; empty where there is none of `min_area`.
std::vector<double> SlopesAlong(const TransitionField& field, double level, double min_area) {
  std::vector<double> slopes;
  if (field.level.empty()) return slopes;
  const std::vector<Polygon> outlines = TraceBoundaries(field, level, 0.1 * min_area);
  if (outlines.empty() || SignedArea(outlines[0]) < min_area) return slopes;
  for (const Eigen::Vector2d& p : outlines[0]) slopes.push_back(field.SlopeAt(p));
  std::sort(slopes.begin(), slopes.end());
  return slopes;
}

}  // namespace

bool HasStainsEdge(const TransitionField& field, double level, double min_area) {
  if (field.level.empty()) return false;
  const std::vector<Polygon> outlines = TraceBoundaries(field, level, 0.1 * min_area);
  if (outlines.empty() || SignedArea(outlines[0]) < min_area) return false;
  double elsewhere = 0;
  for (std::size_t k = 1; k < outlines.size(); ++k) elsewhere += SignedArea(outlines[k]);
  const double area = SignedArea(outlines[0]);
  if (elsewhere > kElsewhere * area || ShapeOf(outlines[0], area, 0).elongation > kRoundStretch) return false;
  const auto round = CompleteOutline(outlines[0]);
  if (!round || round->rms > kRoundStainRms) return false;
  const SectorLevels levels = LevelsBeside(field, outlines[0]);
  int soft = 0;
  for (std::size_t k = 0; k < kEdgeSectors; ++k) {
    const double count = std::max(1.0, levels.count[k]);
    const bool sharp = levels.inside[k] / count >= kInside && std::abs(levels.outside[k] / count) <= kOutside;
    soft += sharp ? 0 : 1;
  }
  return soft <= kMostSoft;
}

bool HasEvenEdge(const TransitionField& field, double level, double min_area) {
  const std::vector<double> slopes = SlopesAlong(field, level, min_area);
  return !slopes.empty() && slopes[slopes.size() / 20] >= kLeastSlopeShare * slopes[slopes.size() / 2];
}

std::optional<double> EdgeWidth(const TransitionField& field, double level, double min_area) {
  const std::vector<double> slopes = SlopesAlong(field, level, min_area);
  if (slopes.empty()) return std::nullopt;
  const double of_kernel = std::sqrt(2 * std::numbers::pi) * field.blur;
  return std::max(0.0, 1 / std::max(1e-3, slopes[slopes.size() / 2]) - of_kernel);
}

}  // namespace drupe
