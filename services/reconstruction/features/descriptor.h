#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "reconstruction/features/extrema.h"
#include "scene/features.h"

namespace drupe {

/// The dominant gradient directions around an extremum (Lowe 2004, section 5), strongest first, at most `max_count`;
/// radians in [-pi, pi), from x towards y. Empty only where the picture is flat.
std::vector<float> DominantOrientations(const Octave& octave, const Extremum& extremum, int max_count);

/// The RootSIFT descriptor (see Features) at an extremum, turned to `orientation`. Writes Features::kDimension values.
void DescribeExtremum(const Octave& octave, const Extremum& extremum, float orientation, std::uint8_t* descriptor);

}  // namespace drupe
