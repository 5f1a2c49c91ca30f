#pragma once

#include "reconstruction/sparse/sfm_state.h"
#include "reconstruction/sparse/uncertainty.h"

namespace drupe {

/// Gives a model without a board a reproducible frame: that of its first registered camera, with the mean distance of
/// the cameras from their middle as the unit of length.
void NormaliseFrame(SfmState& state);

/// The result of structure from motion with its residuals and uncertainties: views in the order of the input, tracks
/// with a position and their active observations.
SparseModel ModelFromState(const SparseInput& input, const SfmState& state, const ModelUncertainty& uncertainty);

}  // namespace drupe
