#pragma once

#include "defect_analysis/defects/transition_field.h"

namespace drupe {

/// Whether a patch of any form, at least 0.9 mm wide, has a sharp rim all along its one outline of `min_area` mm2 at
/// the level `level`: from 0.15 to 0.35 mm inside it to as far outside, the level falls by half a step or more at seven
/// places of eight, and by `sigmas` times as much on average as it differs from place to place. So it does about a
/// scar, however faint and however uneven the skin is farther off; light fades out over a millimetre or more, or ends
/// on one side only, and slivers of shade are narrower. A rim beside skin that no view saw is none.
bool HasSharpRim(const TransitionField& field, double level, double min_area, double sigmas);

}  // namespace drupe
