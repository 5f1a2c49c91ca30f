#pragma once

#include <vector>

#include "base/run_context.h"
#include "base/status.h"
#include "reconstruction/sparse/bundle_adjustment.h"
#include "reconstruction/sparse/sfm_state.h"

namespace drupe {

/// Standard uncertainties of an adjusted model, each the root of the expected squared distance from the truth.
struct ModelUncertainty {
  std::vector<double> centre_sigma;        ///< per view: of the camera's centre, in the world's unit; 0 where not known
  std::vector<double> rotation_sigma_rad;  ///< per view: angle of its rotation
  std::vector<double> position_sigma;      ///< per track: of its position; 0 for tracks without one
};

/// From the covariance of the final adjustment: the inverse of the normal equations, tracks eliminated (Schur
/// complement; Triggs et al. 2000, section 9), for the views; for a track what its rays leave open and what its views'
/// uncertainty adds. `noise` as EstimateNoise found it, widened here by the redundancy. In the frame of the model: the
/// board's, or that of the first view (which then has none) with the mean distance of the cameras from their middle as
/// the unit. The intrinsics count as known. All are 0, not known, where the equations are singular. Error: `cancelled`.
Result<ModelUncertainty> EstimateUncertainty(const SfmState& state, const NoiseLevels& noise,
                                             const AdjustmentOptions& losses, const RunContext& context);

}  // namespace drupe
