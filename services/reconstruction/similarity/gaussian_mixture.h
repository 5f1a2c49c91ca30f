#pragma once

#include <Eigen/Core>
#include <cstdint>

#include "base/run_context.h"
#include "base/status.h"

namespace drupe {

/// Samples, one a column.
using SampleMatrix = Eigen::MatrixXf;

/// A mixture of Gaussians with diagonal covariances (paper eq. 2).
struct GaussianMixture {
  Eigen::VectorXf weights;    ///< K, sum 1
  Eigen::MatrixXf means;      ///< D x K
  Eigen::MatrixXf variances;  ///< D x K, > 0

  Eigen::Index size() const { return weights.size(); }

  /// P(component | sample), K x T, for T samples.
  Eigen::MatrixXf Posteriors(const SampleMatrix& samples) const;
};

/// Fits `components` Gaussians by k-means and expectation-maximisation, the same for the same seed. Takes at least
/// `components` samples. Errors: `cancelled`.
Result<GaussianMixture> FitGaussianMixture(const SampleMatrix& samples, int components, int iterations,
                                           const RunContext& context);

}  // namespace drupe
