#pragma once

#include "defect_analysis/defects/skin_map.h"
#include "scene/fruit_cloud.h"

namespace drupe {

/// A copy of `fruit` with points added where the cloud has gaps of at most `width_mm` (a highlight, the seam between
/// two views), so that a defect which a gap crosses stays one defect with one outline. An added point lies on the
/// surface in the middle of a cell of `map` and has the colour that spreads smoothly from the gap's edges. Added points
/// follow the measured ones. A wider unseen part of the skin (the underside, a hidden side) stays empty.
FruitCloud BridgeGaps(const FruitCloud& fruit, const SkinMap& map, double width_mm);

}  // namespace drupe
