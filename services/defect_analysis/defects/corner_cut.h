#pragma once

#include <array>
#include <optional>

#include "defect_analysis/defects/round_outline.h"

namespace drupe {

/// The two roundish spots whose joint outline this is, each completed, where the outline turns sharply inwards at two
/// corners: there the rims of two spots of one colour that overlap cross, however wide they have grown together. Each
/// part must follow a round form to a twentieth of its radius, be at most half again as long as wide and hold
/// `min_area` mm2, and neither may hide most of the other. Nothing for any other outline: a smooth waist has no
/// corners, and beside a horn or between two bays there are not two spots.
std::optional<std::array<CompletedOutline, 2>> CutAtCorners(const Polygon& outline, double min_area);

}  // namespace drupe
