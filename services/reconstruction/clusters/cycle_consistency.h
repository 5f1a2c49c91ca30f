#pragma once

#include <vector>

#include "base/status.h"
#include "scene/view_graph.h"

namespace drupe {

/// When a verified pair is held to be wrong because its relative pose does not fit those of the other pairs.
struct CycleOptions {
  /// 1..180, degrees; a pair whose relative rotation is farther than this from what the other pairs say is dropped.
  /// Weak pairs of a plane board are right and still off by up to 5.
  double max_rotation_deg = 10.0;
  /// 1..180, degrees; a pair whose direction misses the triangles it forms with others by more than this is dropped.
  double max_direction_deg = 20.0;

  /// 400 `invalid_option` naming the field that is out of its range.
  Status Check() const;
};

struct CycleReport {
  std::vector<ImagePair> dropped;  ///< ascending
  int triplets = 0;                ///< cycles of three pairs that were looked at
};

/// Drops the pairs whose relative rotation or direction of movement does not close cycles with the others (paper 3.1.1;
/// Zach, Klopschitz & Pollefeys 2010): a pattern that repeats verifies matches of places that are not the same. Pairs
/// are weighed by the triplets they close (within sqrt(3) times the bound); along the spanning tree of those that close
/// most, absolute rotations are found and made robust by reweighting (Chatterjee & Govindu 2013); pairs far from them
/// go. Then the directions, turned into one frame: three of a triplet must form a triangle. Pairs without a relative
/// pose, and those in no cycle, stay. Errors: 400 `invalid_option`, 400 `invalid_pair`.
Result<CycleReport> DropInconsistentPairs(int image_count, const CycleOptions& options, MatchGraph& graph);

}  // namespace drupe
