#include "reconstruction/sparse/fusion.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <optional>

#include "base/parallel.h"
#include "reconstruction/sparse/robust_sim3.h"

namespace drupe {
namespace {

constexpr int kMinInliers = 12;
constexpr double kMinInlierShare = 0.4;
constexpr double kMinTrackAngleRad = 0.02;  // of a track's rays, for the tolerance of its position
constexpr double kCentreTolerance = 0.02;   // of a camera's distance from what it sees

/// The distance by which a track's position may be off when its observations are off by `error_px`: in depth, which its
/// rays fix worst.
double ToleranceOf(const SfmState& state, const SfmTrack& track, double error_px) {
  Eigen::Vector3d first = Eigen::Vector3d::Zero(), last = Eigen::Vector3d::Zero();
  for (const SfmObservation& observation : state.ObservationsOf(track)) {
    if (!observation.is_active) continue;
    const Eigen::Vector3d ray = state.poses[observation.view]->Centre() - track.position;
    if (first.isZero()) first = ray;
    last = ray;
  }
  const double angle = std::atan2(first.cross(last).norm(), first.dot(last));
  return error_px / state.FocalPx() * last.norm() / std::max(kMinTrackAngleRad, angle);
}

std::vector<FramePair> SharedPoints(const ClusterModel& a, const ClusterModel& b, double error_px) {
  std::vector<FramePair> pairs;
  for (std::size_t i = 0, j = 0; i < a.whole_track.size() && j < b.whole_track.size();) {
    if (a.whole_track[i] != b.whole_track[j]) {
      a.whole_track[i] < b.whole_track[j] ? ++i : ++j;
      continue;
    }
    const SfmTrack &in_a = a.state.tracks[i++], &in_b = b.state.tracks[j++];
    if (!in_a.has_position || !in_b.has_position) continue;
    pairs.push_back({in_a.position, in_b.position, ToleranceOf(b.state, in_b, error_px)});
  }
  return pairs;
}

void AddSharedCentres(const ClusterModel& a, const ClusterModel& b, std::vector<FramePair>& pairs) {
  if (pairs.empty()) return;
  const Eigen::Vector3d middle = pairs[pairs.size() / 2].to;
  for (int v = 0; v < a.state.ViewCount(); ++v) {
    if (!a.state.poses[v] || !b.state.poses[v]) continue;
    const Eigen::Vector3d to = b.state.poses[v]->Centre();
    pairs.push_back({a.state.poses[v]->Centre(), to, kCentreTolerance * (to - middle).norm()});
  }
}

std::optional<ClusterLink> Link(const ClusterModel& a, const ClusterModel& b, const SparseOptions& options,
                                std::uint64_t seed) {
  std::vector<FramePair> pairs = SharedPoints(a, b, options.max_reprojection_error_px);
  AddSharedCentres(a, b, pairs);
  const auto estimate = EstimateSim3(pairs, seed);
  if (!estimate) return std::nullopt;
  const bool is_enough = estimate->inlier_count >= kMinInliers &&
                         estimate->inlier_count >= kMinInlierShare * static_cast<double>(pairs.size());
  if (!is_enough) return std::nullopt;
  ClusterLink link;
  link.second_from_first = estimate->to_from;
  link.inliers = estimate->inlier_count;
  return link;
}

/// Where the frames begin: every metric model, or else the one with most views.
std::vector<std::optional<Sim3>> Roots(const std::vector<ClusterModel>& models) {
  std::vector<std::optional<Sim3>> frames(models.size());
  std::size_t largest = 0;
  bool any_metric = false;
  for (std::size_t c = 0; c < models.size(); ++c) {
    if (models[c].state.is_metric) frames[c] = Sim3{}, any_metric = true;
    if (models[c].state.RegisteredCount() > models[largest].state.RegisteredCount()) largest = c;
  }
  if (!any_metric) frames[largest] = Sim3{};
  return frames;
}

/// Carries the frames along the links, the strongest that leads to a new cluster first (Prim 1957: the maximum spanning
/// tree, begun from the roots).
void Spread(const std::vector<ClusterLink>& links, std::vector<std::optional<Sim3>>& frames) {
  while (true) {
    const ClusterLink* best = nullptr;
    for (const ClusterLink& link : links) {
      if (frames[link.first].has_value() == frames[link.second].has_value()) continue;
      if (best == nullptr || link.inliers > best->inliers) best = &link;
    }
    if (best == nullptr) return;
    if (frames[best->first]) {
      frames[best->second] = *frames[best->first] * best->second_from_first.Inverse();
    } else {
      frames[best->first] = *frames[best->second] * best->second_from_first;
    }
  }
}

int CountActive(const SfmState& state, int view) {
  const auto& seen = state.view_observations[view];
  return static_cast<int>(
      std::count_if(seen.begin(), seen.end(), [&](std::size_t o) { return state.observations[o].is_active; }));
}

}  // namespace

std::vector<ClusterLink> LinkClusters(const std::vector<ClusterModel>& models, const SparseOptions& options,
                                      const RunContext& context) {
  const std::size_t n = models.size();
  std::vector<std::optional<ClusterLink>> found(n * n);
  const Status done = ParallelFor(context, n * n, [&](std::size_t i) {
    const std::size_t a = i / n, b = i % n;
    if (a < b) found[i] = Link(models[a], models[b], options, context.seed + i);
  });
  std::vector<ClusterLink> links;
  for (std::size_t i = 0; done.ok() && i < found.size(); ++i) {
    if (!found[i]) continue;
    found[i]->first = static_cast<int>(i / n), found[i]->second = static_cast<int>(i % n);
    links.push_back(*found[i]);
  }
  return links;
}

bool FuseClusters(const std::vector<ClusterModel>& models, const SparseOptions& options, const RunContext& context,
                  SfmState& whole) {
  if (models.empty()) return false;
  std::vector<std::optional<Sim3>> frames = Roots(models);
  const bool all_metric =
      std::all_of(frames.begin(), frames.end(), [](const auto& frame) { return frame.has_value(); });
  if (!all_metric) Spread(LinkClusters(models, options, context), frames);
  std::vector<int> most(whole.ViewCount(), -1);
  for (std::size_t c = 0; c < models.size(); ++c) {
    const SfmState& state = models[c].state;
    whole.is_metric = whole.is_metric || state.is_metric;
    for (int v = 0; frames[c] && v < whole.ViewCount(); ++v) {
      if (!state.poses[v]) continue;
      const int active = CountActive(state, v);
      if (active <= most[v]) continue;
      most[v] = active;
      whole.poses[v] = TransformPose(*state.poses[v], *frames[c]);
    }
  }
  return whole.RegisteredCount() > 0;
}

}  // namespace drupe
