#pragma once

#include <cstdint>
#include <span>

#include "reconstruction/matching/epipolar.h"

namespace drupe {

/// The largest share of the pairs, 0..1, that one homography explains within max_error (transfer into the second
/// picture): near 1 for a plane or a camera that only turned. 0 for fewer than four pairs.
double HomographyInlierShare(std::span<const PointPair> pairs, double max_error, std::uint64_t seed);

}  // namespace drupe
