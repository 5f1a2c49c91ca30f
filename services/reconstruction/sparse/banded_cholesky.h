#pragma once

#include <Eigen/Core>
#include <optional>

namespace drupe {

/// Solves normal * x = right for a positive definite matrix, of which `normal` holds the lower triangle: blocks of
/// `block` rows, one a view, most of them zero where views have no track in common, and after them at most one single
/// row that may be full (the board's ink spread). The blocks are brought near the diagonal (Cuthill & McKee 1969,
/// reversed), and what lies between each column's diagonal and its last entry is factorised by dense panels: the cost
/// grows with the number of blocks and the square of the band. Nothing when the matrix is not positive definite.
std::optional<Eigen::VectorXd> SolveBanded(const Eigen::MatrixXd& normal, const Eigen::VectorXd& right, int block);

}  // namespace drupe
