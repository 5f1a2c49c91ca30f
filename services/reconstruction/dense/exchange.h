#pragma once

#include <vector>

#include "base/run_context.h"
#include "base/status.h"
#include "reconstruction/dense/level_context.h"

namespace drupe::dense {

/// Lets every view try the patches that its neighbours grew and that agreed in its picture, where its own map is empty:
/// a patch belongs to all views that see it (PMVS registers it in each of them). So what hardly two views reach from
/// their own side, down between two fruits, is confirmed by all that see it. Nothing grows on from there: beyond, where
/// no view's own growth arrived, lies mostly what is no surface.
Status ExchangePatches(const LevelContext& context, const RunContext& run, std::vector<PatchMap>* maps);

}  // namespace drupe::dense
