#pragma once

#include <cstdint>
#include <vector>

#include "reconstruction/dense/level_context.h"
#include "reconstruction/dense/visibility.h"

namespace drupe::dense {

/// Colours the points of a cloud: fills colours and raw_colours. `owners` has the reference view of each point; `maps`
/// are patches of all views at the level of `context`, which tell what hides what. Every point takes the views that see
/// it, frontal ones first, without those that are brighter (highlights) or darker (shadow, another object) than their
/// weighted median. With `remove_shading`, what the lamps do is divided out of `colours`, so that it is that of the
/// skin: the diffuse shading common to all views (ShadingModel), and what each view's light adds to it from place to
/// place (ViewLight); without, both are the same.
Status ColourPoints(const LevelContext& context, const std::vector<PatchMap>& maps, const std::vector<int>& owners,
                    bool remove_shading, const RunContext& run, PointCloud* cloud);

}  // namespace drupe::dense
