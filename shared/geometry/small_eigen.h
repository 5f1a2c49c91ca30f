#pragma once

#include <Eigen/Core>
#include <span>
#include <vector>

namespace drupe {

/// Up to 10 x 10, without allocation. One size for all: a solver of general eigenvalues takes ten seconds to compile.
using SmallMatrix = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::ColMajor, 10, 10>;
using SmallVector = Eigen::Matrix<double, Eigen::Dynamic, 1, Eigen::ColMajor, 10, 1>;

/// The eigenvalues of a square matrix whose imaginary part is at most tolerance * (1 + |real part|), by the QR
/// algorithm. None for numbers that are not finite.
std::vector<double> RealEigenvalues(SmallMatrix matrix, double tolerance);

/// The vector x with matrix * x about 0, for a square matrix that lacks one rank, by elimination with full pivoting.
/// Not finite when it lacks more.
SmallVector NullVector(SmallMatrix matrix);

/// The real roots, in the sense of RealEigenvalues, of c[0] + c[1] x + ... + c[n] x^n with n = 1..10 and c[n] != 0.
std::vector<double> RealRoots(std::span<const double> coefficients, double tolerance);

}  // namespace drupe
