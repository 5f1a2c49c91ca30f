#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "base/run_context.h"
#include "base/status.h"
#include "scene/features.h"

namespace drupe {

/// How many pictures one is compared with to find its static features, as far as there are so many.
inline constexpr std::size_t kComparedForStatic = 12;

/// The pictures with which picture `image` of a set of `count` is compared, the nearest in the set's order first:
/// evenly spread over those before it; for the first kComparedForStatic, the others of these. What comes later in a set
/// therefore changes nothing about a picture.
std::vector<std::size_t> ComparedForStatic(std::size_t image, std::size_t count);

/// Finds the features of a picture that stand still while the scene turns (a box behind the turntable, dust on the
/// lens): the same look at the same place, within `radius_px`, in at least `min_share` of the pictures compared, and in
/// 3 at least; and in as large a share of the second half of `compared`, the pictures farther away, in which what turns
/// slowly (near the axis, or at the fruit's edge between pictures of a degree) is no longer there. A camera that moves
/// leaves nothing in its place, so nothing is found then. Result: per keypoint, 1 for static.
std::vector<std::uint8_t> FindStaticFeatures(const Features& picture, std::span<const Features> compared,
                                             double radius_px, double min_share);

/// The same of every picture of a set, each with those that ComparedForStatic names. Errors: `cancelled`.
Result<std::vector<std::vector<std::uint8_t>>> FindStaticFeatures(std::span<const Features> features, double radius_px,
                                                                  double min_share, const RunContext& context);

}  // namespace drupe
