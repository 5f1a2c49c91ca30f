#pragma once

#include <functional>

#include "reconstruction/dense/patch_map.h"

namespace drupe::dense {

struct SurfaceFitSettings {
  int radius = 3;            ///< cells: the fit uses (2 radius + 1)^2 cells
  float window_px = 7;       ///< side of the photo-consistency window: patches nearer than it are not independent
  float least_share = 0.3f;  ///< of the cells about a patch that must hold the same surface
};

/// Replaces every patch by the value and slope of the quadric that fits it and its neighbours best, each weighted by
/// its uncertainty (PMVS's neighbour agreement, used as an estimator: the skin is smooth over the distance of a few
/// cells). Patches that lie off the quadric or have too few neighbours on it are removed. sigma becomes that of the
/// fit.
/// The patches that come in are planes fitted over windows of a curved surface; those that go out lie on it
/// (PlaneBias). Stops early when `cancelled`.
PatchMap FitSurface(const PatchMap& map, const SurfaceFitSettings& settings,
                    const std::function<bool()>& cancelled = {});

/// What a plane fitted over a window of window_px x window_px pixels lies off the curved surface at the window's middle
/// (in w): the mean of the surface's second-order part over the window.
float PlaneBias(const PatchCell& cell, float window_px);

}  // namespace drupe::dense
