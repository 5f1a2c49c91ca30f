#include "reconstruction/similarity/similarity.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "reconstruction/similarity/fisher_vector.h"
#include "reconstruction/similarity/gaussian_mixture.h"
#include "reconstruction/similarity/pca.h"
#include "reconstruction/similarity/ring_of_looks.h"

namespace drupe {
namespace {

/// Two groups in the plane: a third about (-3, 0), the rest about (4, 1).
SampleMatrix TwoGroups(int count, Random& random) {
  SampleMatrix samples(2, count);
  for (int t = 0; t < count; ++t) {
    const bool is_left = t % 3 == 0;
    samples.col(t) << random.Normal(is_left ? -3 : 4, is_left ? 0.5 : 1), random.Normal(is_left ? 0 : 1, 0.7);
  }
  return samples;
}

TEST(GaussianMixtureTest, FindsTheGroups) {
  Random random(1);
  const Result<GaussianMixture> mixture = FitGaussianMixture(TwoGroups(6000, random), 2, 30, {});
  ASSERT_TRUE(mixture.ok());
  const int left = mixture->means(0, 0) < mixture->means(0, 1) ? 0 : 1;
  EXPECT_NEAR(mixture->weights[left], 1.0 / 3, 0.01);
  EXPECT_NEAR(mixture->means(0, left), -3, 0.05);
  EXPECT_NEAR(mixture->means(1, 1 - left), 1, 0.05);
  EXPECT_NEAR(mixture->variances(0, left), 0.25, 0.03);
  EXPECT_NEAR(mixture->variances(0, 1 - left), 1, 0.06);
}

TEST(GaussianMixtureTest, PosteriorsSumToOne) {
  Random random(2);
  const SampleMatrix samples = TwoGroups(300, random);
  const Result<GaussianMixture> mixture = FitGaussianMixture(samples, 5, 5, {});
  ASSERT_TRUE(mixture.ok());
  const Eigen::MatrixXf posteriors = mixture->Posteriors(samples);
  EXPECT_GE(posteriors.minCoeff(), 0);
  for (Eigen::Index t = 0; t < samples.cols(); ++t) EXPECT_NEAR(posteriors.col(t).sum(), 1, 1e-4);
}

/// log P of the samples' mean under the mixture, as eqs 1 and 2 say, straight from the formula.
double MeanLogLikelihood(const SampleMatrix& samples, const GaussianMixture& mixture) {
  double sum = 0;
  for (Eigen::Index t = 0; t < samples.cols(); ++t) {
    double density = 0;
    for (Eigen::Index k = 0; k < mixture.size(); ++k) {
      double factor = mixture.weights[k];
      for (Eigen::Index d = 0; d < samples.rows(); ++d) {
        const double apart = samples(d, t) - mixture.means(d, k), variance = mixture.variances(d, k);
        factor *= std::exp(-apart * apart / (2 * variance)) / std::sqrt(6.283185307179586 * variance);
      }
      density += factor;
    }
    sum += std::log(density);
  }
  return sum / static_cast<double>(samples.cols());
}

TEST(FisherVectorTest, IsTheGradientOfTheLogLikelihood) {
  Random random(3);
  GaussianMixture mixture = FitGaussianMixture(TwoGroups(2000, random), 2, 20, {}).value();
  SampleMatrix samples = TwoGroups(150, random);
  samples.row(0).array() += 0.3f;
  const Eigen::VectorXf fisher = FisherVector(samples, mixture);
  ASSERT_EQ(fisher.size(), 2 * (1 + 2 * 2));
  EXPECT_NEAR(fisher.norm(), 1, 1e-5);
  // d L / d mean = sqrt(w) / sigma * (what the vector holds before power and L2), so squares have the gradients'
  // ratios.
  std::vector<double> expected, found;
  for (int k = 0; k < 2; ++k) {
    for (int d = 0; d < 2; ++d) {
      GaussianMixture more = mixture, less = mixture;
      constexpr float kStep = 1e-2f;
      more.means(d, k) += kStep;
      less.means(d, k) -= kStep;
      const double gradient = (MeanLogLikelihood(samples, more) - MeanLogLikelihood(samples, less)) / (2 * kStep);
      expected.push_back(gradient * std::sqrt(mixture.variances(d, k) / mixture.weights[k]));
      const double entry = fisher[2 + k * 2 + d];
      found.push_back(entry * std::abs(entry));
    }
  }
  const auto largest =
      std::max_element(expected.begin(), expected.end(), [](double a, double b) { return std::abs(a) < std::abs(b); }) -
      expected.begin();
  for (std::size_t i = 0; i < expected.size(); ++i) {
    EXPECT_NEAR(found[i] / found[largest], expected[i] / expected[largest], 0.02);
  }
}

TEST(FisherVectorTest, NoSamplesGiveZero) {
  Random random(4);
  const GaussianMixture mixture = FitGaussianMixture(TwoGroups(100, random), 2, 3, {}).value();
  EXPECT_EQ(FisherVector(SampleMatrix(2, 0), mixture).norm(), 0);
}

TEST(PcaTest, KeepsTheLargestDirection) {
  Random random(5);
  Eigen::MatrixXf samples(3, 500);
  for (int t = 0; t < 500; ++t) {
    const float along = random.Normal(0, 5);
    samples.col(t) << along + random.Normal(2, 0.1), -along + random.Normal(0, 0.1), random.Normal(1, 0.1);
  }
  const Pca pca = FitPca(samples, 1);
  EXPECT_NEAR(std::abs(pca.basis.col(0).dot(Eigen::Vector3f(1, -1, 0).normalized())), 1, 1e-3);
  EXPECT_NEAR(pca.Reduce(samples).mean(), 0, 1e-3);
}

TEST(SimilarityTest, NeighboursOnARingAreMostAlike) {
  constexpr int kCount = 18;
  const Result<SimilarityGraph> graph = RunSimilarity(Ring(kCount), {}, {});
  ASSERT_TRUE(graph.ok());
  float largest = 0;
  for (int a = 0; a < kCount; ++a) {
    EXPECT_EQ(graph->Distance(a, a), 0);
    EXPECT_LT(graph->Distance(a, (a + 1) % kCount), graph->Distance(a, (a + 3) % kCount));
    EXPECT_LT(graph->Distance(a, (a + 2) % kCount), graph->Distance(a, (a + 9) % kCount));
    for (int b = 0; b < kCount; ++b) {
      EXPECT_EQ(graph->Distance(a, b), graph->Distance(b, a));
      largest = std::max(largest, graph->Distance(a, b));
    }
  }
  EXPECT_FLOAT_EQ(graph->Weight(0, 1), largest - graph->Distance(0, 1));
}

TEST(SimilarityTest, PicturesWithoutFeaturesAreUnlikeAll) {
  std::vector<Features> pictures = Ring(6);
  pictures.emplace_back();
  const Result<SimilarityGraph> graph = RunSimilarity(pictures, {}, {});
  ASSERT_TRUE(graph.ok());
  EXPECT_EQ(graph->Weight(0, 6), 0);
  EXPECT_GT(graph->Weight(0, 1), 0);
  EXPECT_EQ(RunSimilarity(std::vector<Features>(3), {}, {}).status().code(), "no_features");
}

TEST(SimilarityTest, SameForAnyNumberOfThreads) {
  const std::vector<Features> pictures = Ring(8);
  RunContext one, three;
  one.threads = 1;
  three.threads = 3;
  const auto a = RunSimilarity(pictures, {}, one), b = RunSimilarity(pictures, {}, three);
  ASSERT_TRUE(a.ok() && b.ok());
  EXPECT_EQ(a->weight, b->weight);
}

}  // namespace
}  // namespace drupe
