#include "reconstruction/sparse/robust_sim3.h"

#include <algorithm>
#include <cmath>

#include "reconstruction/sparse/random_sample.h"

namespace drupe {
namespace {

constexpr int kMaxSamples = 1000;
constexpr double kConfidence = 0.9999;
constexpr int kRefinements = 4;

/// Squared distance in units of the tolerance.
double SquaredMiss(const Sim3& to_from, const FramePair& pair) {
  return (to_from * pair.from - pair.to).squaredNorm() / (pair.tolerance * pair.tolerance);
}

double TruncatedCost(const Sim3& to_from, std::span<const FramePair> pairs) {
  double cost = 0;
  for (const FramePair& pair : pairs) cost += std::min(1.0, SquaredMiss(to_from, pair));
  return cost;
}

int MarkInliers(const Sim3& to_from, std::span<const FramePair> pairs, std::vector<std::uint8_t>& is_inlier) {
  is_inlier.resize(pairs.size());
  int count = 0;
  for (std::size_t i = 0; i < pairs.size(); ++i) count += is_inlier[i] = SquaredMiss(to_from, pairs[i]) <= 1 ? 1 : 0;
  return count;
}

Result<Sim3> FitMarked(std::span<const FramePair> pairs, const std::vector<std::uint8_t>& is_used) {
  std::vector<Eigen::Vector3d> from, to;
  for (std::size_t i = 0; i < pairs.size(); ++i) {
    if (!is_used[i]) continue;
    from.push_back(pairs[i].from);
    to.push_back(pairs[i].to);
  }
  return FitSim3(from, to);
}

/// The best similarity so far.
class Best {
 public:
  explicit Best(std::span<const FramePair> pairs)
      : pairs_(pairs), cost_(std::nextafter(static_cast<double>(pairs.size()), 0.0)) {}

  bool Consider(const Result<Sim3>& candidate) {
    if (!candidate.ok()) return false;
    const double cost = TruncatedCost(*candidate, pairs_);
    if (!(cost < cost_)) return false;
    cost_ = cost;
    estimate_.to_from = *candidate;
    estimate_.inlier_count = MarkInliers(*candidate, pairs_, estimate_.is_inlier);
    return true;
  }
  void Refine() {
    for (int k = 0; k < kRefinements; ++k) {
      const std::vector<std::uint8_t> used = estimate_.is_inlier;
      if (!Consider(FitMarked(pairs_, used))) return;
    }
  }
  const RobustSim3& estimate() const { return estimate_; }

 private:
  std::span<const FramePair> pairs_;
  double cost_;
  RobustSim3 estimate_;
};

int SamplesNeeded(double inlier_share) {
  const double all_good = std::pow(inlier_share, 3);
  if (all_good > 1 - 1e-9) return 1;
  return static_cast<int>(std::min<double>(kMaxSamples, std::ceil(std::log(1 - kConfidence) / std::log1p(-all_good))));
}

}  // namespace

std::optional<RobustSim3> EstimateSim3(std::span<const FramePair> pairs, std::uint64_t seed) {
  if (pairs.size() < 3) return std::nullopt;
  RandomSampler random(seed);
  Best best(pairs);
  int needed = kMaxSamples;
  for (int sample = 0; sample < needed; ++sample) {
    const auto picked = random.Distinct<3>(pairs.size());
    std::vector<Eigen::Vector3d> from, to;
    for (const std::size_t i : picked) from.push_back(pairs[i].from), to.push_back(pairs[i].to);
    if (!best.Consider(FitSim3(from, to))) continue;
    best.Refine();
    needed = SamplesNeeded(static_cast<double>(best.estimate().inlier_count) / static_cast<double>(pairs.size()));
  }
  const bool is_supported =
      best.estimate().inlier_count > 3 || best.estimate().inlier_count == static_cast<int>(pairs.size());
  if (!is_supported) return std::nullopt;
  return best.estimate();
}

}  // namespace drupe
