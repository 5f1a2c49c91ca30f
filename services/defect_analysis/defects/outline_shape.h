#pragma once

#include <vector>

#include "defect_analysis/defects/contour.h"

namespace drupe {

/// Cuts an outline of two touching spots of one colour: at two sharp corners (CutAtCorners), or where it narrows to a
/// neck between two roundish parts: a watershed of the distance to the outline, where the neck is narrower than 0.75 of
/// the smaller part's width (0.87 when both parts follow discs closely) and each part nearly fills, and hardly exceeds,
/// a disc of its width. The cut ends are completed. One polygon, the same, when there is no such neck. Parts of less
/// than `min_area` (mm2) are not cut off.
std::vector<Polygon> SplitAtNeck(const Polygon& outline, double min_area);

}  // namespace drupe
