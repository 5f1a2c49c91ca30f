#pragma once

#include <Eigen/Core>

namespace drupe {

// The products of matrices of this stage, in one place: each one that a file writes itself takes it seconds longer to
// compile.

/// a^T b
Eigen::MatrixXf TransposeTimes(const Eigen::MatrixXf& a, const Eigen::MatrixXf& b);
/// a b^T
Eigen::MatrixXf TimesTranspose(const Eigen::MatrixXf& a, const Eigen::MatrixXf& b);

}  // namespace drupe
