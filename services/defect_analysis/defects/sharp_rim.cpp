#include "defect_analysis/defects/sharp_rim.h"

#include <algorithm>
#include <cmath>

#include "defect_analysis/defects/classify.h"
#include "defect_analysis/defects/contour.h"

namespace drupe {
namespace {

constexpr double kLeastWidth = 0.9;               // mm: a narrower one has no even middle
constexpr double kOtherPieces = 0.2;              // of the area, in further outlines
constexpr std::size_t kRimPieces = 32;            // of the outline, each judged by itself
constexpr std::size_t kMostBlurred = 4;           // of them
constexpr double kRimFrom = 0.15, kRimTo = 0.35;  // mm from the outline where the edge must have ended
constexpr int kRimSamples = 3;
constexpr double kLeastFall = 0.5;  // of the level, across a piece of the rim

// Away from a counter-clockwise outline at its point i, from the chord over a piece's length.
Eigen::Vector2d OutwardAt(const Polygon& outline, std::size_t i) {
  const std::size_t count = outline.size(), reach = std::max<std::size_t>(1, count / (2 * kRimPieces));
  const Eigen::Vector2d chord = outline[(i + reach) % count] - outline[(i + count - reach) % count];
  return Eigen::Vector2d(chord.y(), -chord.x()).normalized();
}

// By how much the level falls outwards across each piece of the outline; 0 where a part of it borders on unseen skin.
std::vector<double> FallsAlong(const TransitionField& field, const Polygon& outline) {
  std::vector<double> falls(kRimPieces, 0), counts(kRimPieces, 0);
  std::vector<bool> unseen(kRimPieces, false);
  for (std::size_t i = 0; i < outline.size(); ++i) {
    const std::size_t piece = i * kRimPieces / outline.size();
    const Eigen::Vector2d outward = OutwardAt(outline, i);
    for (int k = 0; k < kRimSamples; ++k) {
      const double at = kRimFrom + (kRimTo - kRimFrom) * k / (kRimSamples - 1);
      const double outside = field.ValueAt(field.full_level, outline[i] + at * outward);
      falls[piece] += field.ValueAt(field.full_level, outline[i] - at * outward) - outside;
      counts[piece] += 1;
      if (outside == 0) unseen[piece] = true;  // to the last bit only where no point is near
    }
  }
  for (std::size_t k = 0; k < kRimPieces; ++k) falls[k] = unseen[k] ? 0 : falls[k] / std::max(1.0, counts[k]);
  return falls;
}

// Whether the falls are as alike as the rim of one stain is.
bool AreAlike(const std::vector<double>& falls, double sigmas) {
  double mean = 0, variance = 0;
  for (const double fall : falls) mean += fall / static_cast<double>(falls.size());
  for (const double fall : falls) variance += (fall - mean) * (fall - mean) / static_cast<double>(falls.size());
  return mean >= sigmas * std::sqrt(variance);
}

}  // namespace

bool HasSharpRim(const TransitionField& field, double level, double min_area, double sigmas) {
  if (field.level.empty()) return false;
  const std::vector<Polygon> outlines = TraceBoundaries(field, level, 0.1 * min_area);
  if (outlines.empty() || SignedArea(outlines[0]) < min_area || outlines[0].size() < 2 * kRimPieces) return false;
  double elsewhere = 0;
  for (std::size_t k = 1; k < outlines.size(); ++k) elsewhere += SignedArea(outlines[k]);
  const double area = SignedArea(outlines[0]);
  if (elsewhere > kOtherPieces * area || ShapeOf(outlines[0], area, 0).width_mm < kLeastWidth) return false;
  const std::vector<double> falls = FallsAlong(field, outlines[0]);
  const auto blurred = static_cast<std::size_t>(
      std::count_if(falls.begin(), falls.end(), [](double fall) { return fall < kLeastFall; }));
  return blurred <= kMostBlurred && AreAlike(falls, sigmas);
}

}  // namespace drupe
