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
/// Seen points stay where they are. Nothing when fewer than 12 points or less than 0.4 of the turn are seen.
std::optional<CompletedOutline> CompleteOutline(const std::vector<Eigen::Vector2d>& seen);

/// Cuts an outline where it narrows to a neck between two roundish parts, as that of two touching spots of one colour:
/// a watershed of the distance to the outline, where the neck is narrower than 0.75 of the smaller part's width and
/// each part nearly fills, and hardly exceeds, a disc of its width. The cut ends are completed. One polygon, the same,
/// when there is no such neck. Parts of less than `min_area` (mm2) are not cut off.
std::vector<Polygon> SplitAtNeck(const Polygon& outline, double min_area);

}  // namespace drupe
