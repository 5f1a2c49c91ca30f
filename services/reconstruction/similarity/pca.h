#pragma once

#include <Eigen/Core>

namespace drupe {

/// The directions in which samples vary most.
struct Pca {
  Eigen::VectorXf mean;
  Eigen::MatrixXf basis;  ///< input dimensions x kept dimensions, orthonormal columns, most variance first

  /// samples (one a column) in the reduced space.
  Eigen::MatrixXf Reduce(const Eigen::MatrixXf& samples) const;
};

/// Keeps `dimensions` <= samples.rows() directions; at least one sample.
Pca FitPca(const Eigen::MatrixXf& samples, int dimensions);

}  // namespace drupe
