#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "base/run_context.h"
#include "base/status.h"
#include "reconstruction/sparse/sfm_state.h"
#include "scene/features.h"

namespace drupe {

struct CompletionCounts {
  int added = 0;   ///< observations that tracks have taken in
  int merged = 0;  ///< tracks that have become part of another
};

/// Lengthens tracks by what matching has missed, once the poses say where each point lies in the pictures (Schoenberger
/// & Frahm 2016, section 4.4): a free feature at the place of a track's point, and like it (FindCompletionLinks), joins
/// the track; where it belongs to another track, the two become one if they have no view in common and the point of the
/// longer one explains all observations of the other. `max_error_px` is for features of sigma 1 (ExpectedSigmaPx).
/// Those most alike go first. Without descriptors nothing is done. Error: `cancelled`.
Result<CompletionCounts> CompleteTracks(std::span<const Features> features,
                                        const std::vector<std::vector<std::uint8_t>>& is_static, double max_error_px,
                                        const RunContext& context, SfmState& state);

}  // namespace drupe
