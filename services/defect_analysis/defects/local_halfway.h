#pragma once

#include "defect_analysis/defects/contour.h"
#include "defect_analysis/defects/transition_field.h"

namespace drupe {

/// Moves an outline from where the field crosses one level everywhere to where it crosses the middle between what lies
/// inside and outside right there: across each of its points, the level is sampled 0.35 to 0.6 mm outside and as far
/// inside as the defect is wide, both are averaged along half a millimetre of the outline, and the point goes to the
/// share `level` of the way between. Shade that covers the skin on one side, or gloss over a part of the defect, so
/// moves the outline no more. An outline between clear skin and an even defect stays where it is.
Polygon FollowLocalHalfway(const TransitionField& field, const Polygon& outline, double level);

}  // namespace drupe
