#include "reconstruction/clusters/normalised_cut.h"

#include <Eigen/Core>
#include <algorithm>
#include <limits>
#include <numeric>

#include "geometry/symmetric_eigen.h"

namespace drupe {
namespace {

/// Weights among the images, sharpened: Fisher distances differ little between near and far, and a cut should feel the
/// difference. The largest weight becomes 1; none is 0, so that the graph is connected.
Eigen::MatrixXd SharpenedWeights(const SimilarityGraph& graph, const std::vector<int>& images) {
  const auto n = static_cast<Eigen::Index>(images.size());
  Eigen::MatrixXd weights = Eigen::MatrixXd::Zero(n, n);
  for (Eigen::Index a = 0; a < n; ++a) {
    for (Eigen::Index b = 0; b < n; ++b) {
      if (a != b) weights(a, b) = graph.Weight(images[a], images[b]);
    }
  }
  const double largest = std::max(weights.maxCoeff(), 1e-12);
  weights = (weights / largest).array().square().max(1e-6);
  weights.diagonal().setZero();
  return weights;
}

/// Positions in order of the second generalised eigenvector of (D - W) y = lambda D y.
std::vector<Eigen::Index> SpectralOrder(const Eigen::MatrixXd& weights) {
  const Eigen::VectorXd scale = weights.rowwise().sum().cwiseSqrt().cwiseInverse();
  const Eigen::MatrixXd normalised = scale.asDiagonal() * weights * scale.asDiagonal();
  const SymmetricEigen eigen = DecomposeSymmetric(normalised);  // ascending: ours is the last but one
  const Eigen::VectorXd y = scale.cwiseProduct(eigen.vectors.col(weights.rows() - 2));
  std::vector<Eigen::Index> order(weights.rows());
  std::iota(order.begin(), order.end(), Eigen::Index{0});
  std::stable_sort(order.begin(), order.end(), [&y](Eigen::Index a, Eigen::Index b) { return y[a] < y[b]; });
  return order;
}

/// How many of the ordered positions the first side gets.
std::size_t BestCut(const Eigen::MatrixXd& weights, const std::vector<Eigen::Index>& order) {
  const Eigen::VectorXd degrees = weights.rowwise().sum();
  const std::size_t n = order.size(), smallest = std::max<std::size_t>(1, n / 3);
  double best = std::numeric_limits<double>::infinity(), cut = 0, inside = 0;
  std::size_t best_size = smallest;
  for (std::size_t size = 1; size + smallest <= n; ++size) {
    const Eigen::Index moved = order[size - 1];
    for (std::size_t k = 0; k < n; ++k) cut += (k < size ? -1 : 1) * weights(moved, order[k]);
    inside += degrees[moved];
    const double value = cut / inside + cut / (degrees.sum() - inside);
    if (size < smallest || value >= best) continue;
    best = value;
    best_size = size;
  }
  return best_size;
}

}  // namespace

std::pair<std::vector<int>, std::vector<int>> NormalisedCut(const SimilarityGraph& graph,
                                                            const std::vector<int>& images) {
  const Eigen::MatrixXd weights = SharpenedWeights(graph, images);
  const std::vector<Eigen::Index> order = SpectralOrder(weights);
  const std::size_t cut = BestCut(weights, order);
  std::pair<std::vector<int>, std::vector<int>> sides;
  for (std::size_t k = 0; k < order.size(); ++k) (k < cut ? sides.first : sides.second).push_back(images[order[k]]);
  std::sort(sides.first.begin(), sides.first.end());
  std::sort(sides.second.begin(), sides.second.end());
  return sides;
}

std::vector<std::vector<int>> DivideByCut(const SimilarityGraph& graph, const std::vector<int>& images, int max_size) {
  std::vector<std::vector<int>> waiting = {images}, done;
  while (!waiting.empty()) {
    std::vector<int> group = std::move(waiting.back());
    waiting.pop_back();
    if (static_cast<int>(group.size()) <= max_size) {
      done.push_back(std::move(group));
      continue;
    }
    auto [left, right] = NormalisedCut(graph, group);
    waiting.push_back(std::move(left));
    waiting.push_back(std::move(right));
  }
  std::sort(done.begin(), done.end());
  return done;
}

}  // namespace drupe
