#include "reconstruction/dense/neighbour_views.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

namespace drupe::dense {

namespace {

constexpr std::size_t kMaxTracks = 3000;
constexpr double kVisibleDeg = 35;  ///< a track seen from one direction is taken as visible this far from it

double Degrees(double cosine) {
  return std::acos(std::clamp(cosine, -1.0, 1.0)) * 180.0 / std::numbers::pi;
}

/// How much a pair under this angle tells about depth without distorting the patch too much; 0..1.
double AngleWeight(double degrees) {
  if (degrees < 2) return 0;
  if (degrees < 8) return (degrees - 2) / 6;
  if (degrees < 25) return 1;
  const double beyond = (degrees - 25) / 12;
  return std::exp(-beyond * beyond);
}

/// Unit directions from the point to the views that are likely to see it; zero for the others.
std::vector<Eigen::Vector3d> DirectionsOfSight(const Track& track, const std::vector<DenseView>& views,
                                               const std::vector<int>& slot_of_view) {
  std::vector<Eigen::Vector3d> towards(views.size()), seen(views.size(), Eigen::Vector3d::Zero());
  for (std::size_t i = 0; i < views.size(); ++i) towards[i] = (views[i].centre - track.position).normalized();
  const double least = std::cos(kVisibleDeg * std::numbers::pi / 180);
  for (const Observation& observation : track.observations) {
    const int slot = slot_of_view[observation.view];
    if (slot < 0) continue;
    for (std::size_t i = 0; i < views.size(); ++i) {
      if (towards[i].dot(towards[slot]) >= least) seen[i] = towards[i];
    }
  }
  return seen;
}

std::vector<int> BestOf(const std::vector<double>& scores) {
  std::vector<int> order;
  const double best = *std::max_element(scores.begin(), scores.end());
  for (int i = 0; i < static_cast<int>(scores.size()); ++i) {
    if (scores[i] > 0.02 * best) order.push_back(i);
  }
  std::stable_sort(order.begin(), order.end(), [&](int a, int b) { return scores[a] > scores[b]; });
  if (order.size() > kMaxNeighbours) order.resize(kMaxNeighbours);
  return order;
}

}  // namespace

std::vector<std::vector<int>> SelectNeighbours(const SparseModel& model, const RegionOfInterest& region,
                                               const std::vector<DenseView>& views) {
  std::vector<int> slot_of_view(model.views.size(), -1);
  for (std::size_t i = 0; i < views.size(); ++i) slot_of_view[views[i].index] = static_cast<int>(i);
  std::vector<const Track*> tracks;
  for (const Track& track : model.tracks) {
    if (region.Contains(track.position)) tracks.push_back(&track);
  }
  std::vector<std::vector<double>> scores(views.size(), std::vector<double>(views.size(), 0));
  const std::size_t step = std::max<std::size_t>(1, tracks.size() / kMaxTracks);
  for (std::size_t t = 0; t < tracks.size(); t += step) {
    const auto seen = DirectionsOfSight(*tracks[t], views, slot_of_view);
    for (std::size_t a = 0; a < views.size(); ++a) {
      for (std::size_t b = 0; b < views.size(); ++b) {
        if (a == b || seen[a].isZero() || seen[b].isZero()) continue;
        scores[a][b] += AngleWeight(Degrees(seen[a].dot(seen[b])));
      }
    }
  }
  std::vector<std::vector<int>> neighbours(views.size());
  for (std::size_t a = 0; a < views.size(); ++a) neighbours[a] = BestOf(scores[a]);
  return neighbours;
}

}  // namespace drupe::dense
