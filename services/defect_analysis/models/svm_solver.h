#pragma once

#include <Eigen/Core>
#include <vector>

#include "base/status.h"

namespace drupe {

/// A decision function sum_i weights_i exp(-gamma |x - vectors_i|^2) + bias, positive for class 1.
struct SvmSolution {
  std::vector<Eigen::Vector3f> vectors;
  std::vector<float> weights;
  float bias = 0;
};

/// Solves the dual problem of a two-class support vector machine with a radial kernel (Cortes and Vapnik 1995; OpenCV's
/// solver, Fan, Chen and Lin 2005). `labels`: 0 or 1, one a point. Errors: 422 `one_class` when only one label occurs,
/// `training_failed`.
Result<SvmSolution> SolveSvm(const std::vector<Eigen::Vector3f>& points, const std::vector<std::uint8_t>& labels,
                             double c, double gamma);

}  // namespace drupe
