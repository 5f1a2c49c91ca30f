#pragma once

#include <optional>

#include "geometry/pinhole_camera.h"
#include "reconstruction/matching/matching.h"
#include "reconstruction/matching/prepared_picture.h"
#include "scene/view_graph.h"

namespace drupe {

/// Matches and verifies one pair. Nothing when it fails: too few verified matches, or a scene that stands still in the
/// picture (one frame twice, or only background).
std::optional<TwoViewMatches> MatchPair(const PreparedPicture& first, const PreparedPicture& second, ImagePair pair,
                                        double focal_px, const MatchingOptions& options, std::uint64_t seed);

}  // namespace drupe
