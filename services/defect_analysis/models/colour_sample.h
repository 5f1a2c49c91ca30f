#pragma once

#include "defect_analysis/models/labelled_colours.h"

namespace drupe {

/// At most `per_class` colours of each class. Every region of the colour space has its share, which grows with the root
/// of its number of points: the board's white would otherwise leave no place for a needle or a spot. Deterministic.
LabelledColours SampleColours(const LabelledColours& from, int per_class);

/// The colour with its hue turned about the grey axis, and all channels multiplied by `gain`.
Rgb8 Recolour(const Rgb8& colour, double turn_deg, double gain);

/// The colours, and `copies` of the fruit's in other hues, evenly around the circle, in turn as light, darker and
/// lighter.
LabelledColours WithRecolouredFruit(const LabelledColours& from, int copies);

/// Splits off every k-th colour of each class, k = round(1 / share). Deterministic.
void SplitOff(double share, LabelledColours& kept, LabelledColours& split);

}  // namespace drupe
