#pragma once

#include "capture/camera/colour_differences.h"
#include "capture/camera/colour_lattice.h"

namespace drupe {

/// Gives filtered differences of a colour back what the filters took from them that was no noise, as Demosaic says
/// (4.), as far as 1 into the margin; `even` has to reach 5, `fine` 1.
void RestoreAgreedDetail(const MeasuredColour& measured, Lattice& fine, Lattice& even);

}  // namespace drupe
