#include "reconstruction/similarity/pca.h"

#include <Eigen/Eigenvalues>

namespace drupe {

Pca FitPca(const Eigen::MatrixXf& samples, int dimensions) {
  Pca pca;
  pca.mean = samples.rowwise().mean();
  const Eigen::MatrixXf centred = samples.colwise() - pca.mean;
  const Eigen::MatrixXf covariance = centred * centred.transpose() / static_cast<float>(samples.cols());
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> solver(covariance.cast<double>());
  pca.basis = solver.eigenvectors().rightCols(dimensions).rowwise().reverse().cast<float>();
  return pca;
}

}  // namespace drupe
