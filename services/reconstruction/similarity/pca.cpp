#include "reconstruction/similarity/pca.h"

#include "geometry/symmetric_eigen.h"

namespace drupe {

Pca FitPca(const Eigen::MatrixXf& samples, int dimensions) {
  Pca pca;
  pca.mean = samples.rowwise().mean();
  const Eigen::MatrixXf centred = samples.colwise() - pca.mean;
  const Eigen::MatrixXf covariance = centred * centred.transpose() / static_cast<float>(samples.cols());
  const SymmetricEigen eigen = DecomposeSymmetric(covariance.cast<double>());
  pca.basis = eigen.vectors.rightCols(dimensions).rowwise().reverse().cast<float>();
  return pca;
}

}  // namespace drupe
