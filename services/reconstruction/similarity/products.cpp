#include "reconstruction/similarity/products.h"

namespace drupe {

Eigen::MatrixXf TransposeTimes(const Eigen::MatrixXf& a, const Eigen::MatrixXf& b) {
  return a.transpose() * b;
}

Eigen::MatrixXf TimesTranspose(const Eigen::MatrixXf& a, const Eigen::MatrixXf& b) {
  return a * b.transpose();
}

}  // namespace drupe
