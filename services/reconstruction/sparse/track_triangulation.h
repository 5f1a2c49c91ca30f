#pragma once

#include "base/run_context.h"
#include "base/status.h"
#include "reconstruction/sparse/sfm_state.h"

namespace drupe {

/// When a track gets a position and which of its observations count.
struct TriangulationOptions {
  double max_error_px = 4.0;     ///< an observation farther from the projection is inactive
  double min_angle_rad = 0.035;  ///< widest angle between two rays of a track
};

/// Brings every track up to date with the poses: positions stay where most observations agree with them; otherwise, and
/// for tracks without one, they are triangulated anew, robustly (from all rays, then from pairs of rays); observations
/// that disagree become inactive and may return later. Tracks with fewer than two active observations, or with rays
/// that meet at too small an angle, lose their position. Error: `cancelled`.
Status UpdateTracks(SfmState& state, const TriangulationOptions& options, const RunContext& context);

/// The number of tracks with a position.
int CountPositions(const SfmState& state);

}  // namespace drupe
