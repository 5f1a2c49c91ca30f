#include "reconstruction/similarity/fisher_vector.h"

#include <cmath>

#include "reconstruction/similarity/products.h"

namespace drupe {

Eigen::VectorXf FisherVector(const SampleMatrix& samples, const GaussianMixture& mixture) {
  const Eigen::Index components = mixture.size(), dimensions = mixture.means.rows();
  Eigen::VectorXf fisher = Eigen::VectorXf::Zero(components * (1 + 2 * dimensions));
  if (samples.cols() == 0) return fisher;
  const auto count = static_cast<float>(samples.cols());
  const Eigen::MatrixXf posteriors = mixture.Posteriors(samples);
  const Eigen::VectorXf totals = posteriors.rowwise().sum() / count;
  const Eigen::MatrixXf sums = TimesTranspose(samples, posteriors) / count;
  const Eigen::MatrixXf squares = TimesTranspose(samples.cwiseAbs2(), posteriors) / count;
  for (Eigen::Index k = 0; k < components; ++k) {
    const Eigen::ArrayXf mean = mixture.means.col(k), variance = mixture.variances.col(k);
    const float weight = mixture.weights[k], root = std::sqrt(weight);
    const Eigen::ArrayXf by_mean = (sums.col(k).array() - totals[k] * mean) / (variance.sqrt() * root);
    const Eigen::ArrayXf spread = squares.col(k).array() - 2 * mean * sums.col(k).array() + totals[k] * mean.square();
    const Eigen::ArrayXf by_variance = (spread / variance - totals[k]) / (root * std::sqrt(2.0f));
    fisher[k] = (totals[k] - weight) / root;
    fisher.segment(components + k * dimensions, dimensions) = by_mean;
    fisher.segment(components * (1 + dimensions) + k * dimensions, dimensions) = by_variance;
  }
  fisher = fisher.array().sign() * fisher.array().abs().sqrt();
  return fisher.normalized();
}

}  // namespace drupe
