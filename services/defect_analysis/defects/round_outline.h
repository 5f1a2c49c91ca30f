#pragma once

#include <optional>
#include <vector>

#include "defect_analysis/defects/contour.h"

namespace drupe {

/// The roundish outline of which only an arc is seen, because another defect covers the rest.
struct CompletedOutline {
  Polygon polygon;
  double rms = 0;         ///< of the seen points about the smooth outline, relative to its mean radius
  double seen_share = 0;  ///< of the turn about its middle
};

/// Completes an outline from its seen points by a circle with two waves of ellipticity, r(t) = r0 + x cos t + y sin t +
/// a cos 2t + b sin 2t about a middle that moves to where x = y = 0; a and b are drawn to 0 the more, the less is seen.
/// The fit is re-weighted against outliers (Tukey's biweight): where an outline meets the one that covers it, both
/// bend. Seen points that the outline agrees with stay where they are. Nothing when fewer than 12 points or less than
/// 0.4 of the turn are seen.
std::optional<CompletedOutline> CompleteOutline(const std::vector<Eigen::Vector2d>& seen);

/// A roundish outline without the horns that shade beside it draws out and the bays that gloss bites in: where a smooth
/// form r(t) of five waves, fitted to the outline with a re-weighting against outliers, leaves at most 0.3 of the turn
/// as outliers and follows the rest to 3 % of the radius, the outliers are replaced by it. Nothing when nothing is to
/// be repaired, or when the outline has no such form (a scar, an irregular decay).
std::optional<Polygon> RepairRoundOutline(const Polygon& outline);

}  // namespace drupe
