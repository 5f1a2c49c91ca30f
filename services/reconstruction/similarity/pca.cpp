#include "reconstruction/similarity/pca.h"

#include "geometry/symmetric_eigen.h"
#include "reconstruction/similarity/products.h"

namespace drupe {

Eigen::MatrixXf Pca::Reduce(const Eigen::MatrixXf& samples) const {
  return TransposeTimes(basis, samples.colwise() - mean);
}

Pca FitPca(const Eigen::MatrixXf& samples, int dimensions) {
  Pca pca;
  pca.mean = samples.rowwise().mean();
  const Eigen::MatrixXf centred = samples.colwise() - pca.mean;
  const Eigen::MatrixXf covariance = TimesTranspose(centred, centred) / static_cast<float>(samples.cols());
  const SymmetricEigen eigen = DecomposeSymmetric(covariance.cast<double>());
  pca.basis = eigen.vectors.rightCols(dimensions).rowwise().reverse().cast<float>();
  return pca;
}

}  // namespace drupe
