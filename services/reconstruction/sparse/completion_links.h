#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "base/run_context.h"
#include "base/status.h"
#include "reconstruction/sparse/sfm_state.h"
#include "scene/features.h"

namespace drupe {

/// A feature that shows the point of a track, by place and look.
struct CompletionLink {
  std::int32_t track = 0;
  FeatureRef feature;
  std::int32_t squared_distance = 0;  ///< of the descriptors of the feature and of the track's nearest observation
};

/// For every track with a position and every registered view without an observation of it that looks from within 30
/// degrees of one that has: the feature that lies within `max_error_px` times its expected sigma of the projection, is
/// of the size expected there and looks most like the nearest observation, and no less so than 95 % of the observations
/// of one track that follow one another. `is_static` as in MatchGraph, may be empty. The most alike come first. Error:
/// `cancelled`.
Result<std::vector<CompletionLink>> FindCompletionLinks(std::span<const Features> features,
                                                        const std::vector<std::vector<std::uint8_t>>& is_static,
                                                        double max_error_px, const RunContext& context,
                                                        const SfmState& state);

}  // namespace drupe
