#pragma once

#include <Eigen/Core>
#include <vector>

#include "base/status.h"
#include "cli/bench/truth_set.h"
#include "geometry/sim3.h"
#include "scene/point_cloud.h"

namespace drupe {

/// A cloud against the true skin. Lengths in mm.
struct DenseErrors {
  std::size_t points = 0;    ///< of the cloud
  std::size_t on_fruit = 0;  ///< of them within 1.5 mm of the furthest skin from a fruit's centre
  double median = 0;         ///< error: distance from the true skin, measured from the fruit's centre
  double p95 = 0;
  double over_03_pct = 0;  ///< share of the points on fruit with an error above 0.3 mm
  /// Share of the skin with a point nearer than 0.10 and 0.20 mm, of the skin that three views or more face at less
  /// than 70 degrees; `visible`: of that part which no fruit hides from three views or more.
  double complete_010_pct = 0, complete_020_pct = 0;
  double visible_010_pct = 0, visible_020_pct = 0;
  /// The 68.3th percentile of error / expected error: 1 when the expected error tells the truth. 0: not known.
  double error_over_expected = 0;
};

/// Compares a cloud with surface.ply of the set, by the rules of the sets' own evaluation: a point's error is its
/// distance from the fruit's centre less the weighted one of the six nearest skin samples. Errors: 400 `bad_truth`.
Result<DenseErrors> CompareCloud(const TruthSet& set, const PointCloud& cloud, const Sim3& truth_from_cloud);

}  // namespace drupe
