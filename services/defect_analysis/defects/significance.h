#pragma once

#include "defect_analysis/defects/defect_options.h"
#include "defect_analysis/defects/transition_field.h"

namespace drupe {

/// Weighted colour difference between a defect's core and the skin about it that gloss cannot explain: gloss adds the
/// lamps' white to all three channels alike (Shafer's dichromatic reflection model, 1985), so as much white as the
/// defect has more than the skin in every channel is taken off first. What absorbs light in any channel, as a stain
/// does, loses nothing.
double ContrastBeyondGloss(const TransitionField& field, double lightness_weight);

/// Whether a patch differs from the skin right beside it, and not only from the smooth model of the whole fruit's skin,
/// which is uncertain near the rim of what is seen: its contrast beyond gloss reaches `threshold`, and the local noise
/// of the skin's colour leaves it local_sigma standard deviations.
bool StandsOut(const TransitionField& field, double threshold, const SegmentationOptions& options);

}  // namespace drupe
