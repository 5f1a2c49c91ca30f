#pragma once

#include "base/run_context.h"
#include "base/status.h"
#include "reconstruction/sparse/sfm_state.h"

namespace drupe {

/// Takes the positions of tracks seen by two views alone that lie far before or behind what the longer tracks show in
/// one of these views: any match along an epipolar line agrees with some depth, and no third view contradicts it. A
/// view's depths are the inner 98 % of its tracks of three views or more, widened by half their range of inverse depth;
/// views with too few of them do not judge. Returns the number of tracks taken.
int DropStrayTracks(SfmState& state);

}  // namespace drupe
