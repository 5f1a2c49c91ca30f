#pragma once

#include <span>
#include <vector>

#include "reconstruction/matching/epipolar.h"
#include "reconstruction/matching/prepared_picture.h"
#include "scene/view_graph.h"

namespace drupe {

struct GuidedOptions {
  double max_error = 0;                   ///< distance from the epipolar line, normalised coordinates
  double max_ratio = 0.8;                 ///< nearest over second nearest descriptor among the candidates
  double inverse_depth_min = 0;           ///< range of inverse depths, see EpipolarTransfer
  double inverse_depth_max = 0;           ///< > inverse_depth_min
  std::int32_t max_squared_distance = 0;  ///< of descriptors
};

/// Second matching with known epipolar lines: every kept feature of `first` is compared with those of `second` that lie
/// near its epipolar line and within the range of depths; nearest, ratio and mutual check as in the first matching. The
/// result names places in `kept`, ascending by `first`.
std::vector<FeatureMatch> MatchGuided(const PreparedPicture& first, const PreparedPicture& second,
                                      const EpipolarTransfer& transfer, const GuidedOptions& options);

}  // namespace drupe
