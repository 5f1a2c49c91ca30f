#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "base/run_context.h"
#include "base/status.h"
#include "scene/features.h"

namespace drupe {

/// Finds features that stand still in the picture while the scene turns (a box behind the turntable, dust on the lens):
/// the same look at the same place, within `radius_px`, in at least `min_share` of the pictures compared, and in 3 at
/// least. Each picture is compared with up to 12 others spread over the set. Result: per picture, per keypoint, 1 for
/// static. A camera that moves leaves nothing in its place, so nothing is found then.
Result<std::vector<std::vector<std::uint8_t>>> FindStaticFeatures(std::span<const Features> features, double radius_px,
                                                                  double min_share, const RunContext& context);

}  // namespace drupe
