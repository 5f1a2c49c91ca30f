#include "reconstruction/similarity/gaussian_mixture.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>
#include <random>
#include <vector>

#include "reconstruction/similarity/products.h"

namespace drupe {
namespace {

constexpr int kKMeansIterations = 8;
/// Variances do not fall below this share of the samples' overall variance: a component must not die on one sample.
constexpr float kVarianceFloor = 0.01f;

/// The index of the nearest mean, for every sample.
std::vector<Eigen::Index> NearestMeans(const SampleMatrix& samples, const Eigen::MatrixXf& means) {
  Eigen::MatrixXf scores = TransposeTimes(means, samples);
  for (Eigen::Index k = 0; k < means.cols(); ++k) scores.row(k).array() -= 0.5f * means.col(k).squaredNorm();
  std::vector<Eigen::Index> nearest(samples.cols());
  for (Eigen::Index t = 0; t < samples.cols(); ++t) scores.col(t).maxCoeff(&nearest[t]);
  return nearest;
}

/// Different samples drawn at random, one a column.
Eigen::MatrixXf DrawMeans(const SampleMatrix& samples, int count, std::uint64_t seed) {
  std::vector<Eigen::Index> order(samples.cols());
  std::iota(order.begin(), order.end(), Eigen::Index{0});
  std::mt19937_64 random(seed);
  Eigen::MatrixXf means(samples.rows(), count);
  for (int k = 0; k < count; ++k) {
    std::swap(order[k], order[k + random() % (order.size() - k)]);
    means.col(k) = samples.col(order[k]);
  }
  return means;
}

/// Lloyd's iterations; a mean that no sample is nearest to stays where it is.
Eigen::MatrixXf KMeans(const SampleMatrix& samples, Eigen::MatrixXf means) {
  for (int iteration = 0; iteration < kKMeansIterations; ++iteration) {
    Eigen::MatrixXf sums = Eigen::MatrixXf::Zero(means.rows(), means.cols());
    Eigen::VectorXf counts = Eigen::VectorXf::Zero(means.cols());
    const std::vector<Eigen::Index> nearest = NearestMeans(samples, means);
    for (Eigen::Index t = 0; t < samples.cols(); ++t) {
      sums.col(nearest[t]) += samples.col(t);
      counts[nearest[t]] += 1;
    }
    for (Eigen::Index k = 0; k < means.cols(); ++k) {
      if (counts[k] > 0) means.col(k) = sums.col(k) / counts[k];
    }
  }
  return means;
}

Eigen::VectorXf OverallVariance(const SampleMatrix& samples) {
  const Eigen::VectorXf mean = samples.rowwise().mean();
  return (samples.colwise() - mean).array().square().rowwise().mean().max(1e-12f);
}

/// The maximisation step. Components without samples keep what they have.
void Maximise(const SampleMatrix& samples, const Eigen::MatrixXf& posteriors, const Eigen::VectorXf& floor,
              GaussianMixture& mixture) {
  const Eigen::VectorXf totals = posteriors.rowwise().sum();
  const Eigen::MatrixXf sums = TimesTranspose(samples, posteriors);
  const Eigen::MatrixXf squares = TimesTranspose(samples.cwiseAbs2(), posteriors);
  for (Eigen::Index k = 0; k < mixture.size(); ++k) {
    if (totals[k] < 1) continue;
    mixture.means.col(k) = sums.col(k) / totals[k];
    const Eigen::VectorXf variance = squares.col(k) / totals[k] - mixture.means.col(k).cwiseAbs2();
    mixture.variances.col(k) = variance.cwiseMax(floor);
  }
  mixture.weights = (totals / static_cast<float>(samples.cols())).cwiseMax(1e-6f);
  mixture.weights /= mixture.weights.sum();
}

}  // namespace

Eigen::MatrixXf GaussianMixture::Posteriors(const SampleMatrix& samples) const {
  // log(w P(x)) = c - sum x^2 / (2 v) + sum x m / v, for all samples by two products.
  const Eigen::MatrixXf precisions = variances.cwiseInverse();
  const Eigen::VectorXf squared = means.cwiseAbs2().cwiseProduct(precisions).colwise().sum();
  const Eigen::VectorXf logs = variances.array().log().matrix().colwise().sum();
  const Eigen::VectorXf constants = weights.array().log().matrix() - 0.5f * (squared + logs);
  Eigen::MatrixXf posteriors = TransposeTimes(means.cwiseProduct(precisions), samples);
  posteriors -= TransposeTimes(0.5f * precisions, samples.cwiseAbs2());
  posteriors.colwise() += constants;
  const Eigen::RowVectorXf highest = posteriors.colwise().maxCoeff();
  posteriors = (posteriors.rowwise() - highest).array().exp();
  const Eigen::RowVectorXf sums = posteriors.colwise().sum();
  return posteriors.array().rowwise() / sums.array();
}

Result<GaussianMixture> FitGaussianMixture(const SampleMatrix& samples, int components, int iterations,
                                           const RunContext& context) {
  const Eigen::VectorXf overall = OverallVariance(samples);
  GaussianMixture mixture;
  mixture.means = KMeans(samples, DrawMeans(samples, components, context.seed));
  mixture.variances = overall.replicate(1, components);
  mixture.weights = Eigen::VectorXf::Constant(components, 1.0f / static_cast<float>(components));
  for (int i = 0; i < iterations; ++i) {
    DRUPE_RETURN_IF_ERROR(context.CheckCancelled());
    Maximise(samples, mixture.Posteriors(samples), kVarianceFloor * overall, mixture);
  }
  return mixture;
}

}  // namespace drupe
