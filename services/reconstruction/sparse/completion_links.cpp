#include "reconstruction/sparse/completion_links.h"

#include <algorithm>
#include <cmath>
#include <tuple>

#include "base/parallel.h"
#include "scene/descriptor_distance.h"
#include "scene/keypoint_grid.h"

namespace drupe {
namespace {

constexpr std::size_t kTracksAChunk = 512;
constexpr double kMaxTurnCosine = 0.866;  // of 30 degrees; SIFT seldom survives a larger turn of the surface
constexpr double kMaxScaleRatio = 1.4;    // of a feature's size and the one expected from the nearest view
constexpr double kUsualShare = 0.95;      // of a track's neighbours look no less alike than a link may
constexpr float kCellPx = 16;

/// An active observation as the search needs it.
struct Look {
  const SfmObservation* observation;
  Eigen::Vector3d direction;  ///< unit, from the point to the camera
  double size;                ///< scale times depth
};

class LinkSearch {
 public:
  LinkSearch(std::span<const Features> features, const std::vector<std::vector<std::uint8_t>>& is_static,
             double max_error_px, const SfmState& state)
      : features_(features), is_static_(is_static), max_error_px_(max_error_px), state_(state) {
    for (const Features& view : features) grids_.emplace_back(view, kCellPx);
    for (const auto& pose : state.poses) centres_.push_back(pose ? pose->Centre() : Eigen::Vector3d::Zero());
    max_squared_distance_ = UsualDistance();
  }

  void Search(std::int32_t t, std::vector<CompletionLink>& links) const {
    const SfmTrack& track = state_.tracks[t];
    if (!track.has_position) return;
    const std::vector<Look> looks = LooksAt(track);
    for (int view = 0; view < state_.ViewCount(); ++view) {
      if (!state_.poses[view] || Observes(track, view)) continue;
      const Look* nearest = NearestLook(looks, (centres_[view] - track.position).normalized());
      if (nearest != nullptr) Offer(t, view, *nearest, links);
    }
  }

 private:
  const Keypoint& KeypointOf(const SfmObservation& observation) const {
    return features_[observation.view].keypoints[observation.keypoint];
  }
  const std::uint8_t* DescriptorOf(const SfmObservation& observation) const {
    return features_[observation.view].Descriptor(observation.keypoint);
  }

  /// How far apart neighbours in one track look at most, but for a twentieth of them.
  std::int32_t UsualDistance() const {
    std::vector<std::int32_t> distances;
    for (const SfmTrack& track : state_.tracks) {
      const SfmObservation* before = nullptr;
      for (const SfmObservation& observation : state_.ObservationsOf(track)) {
        if (!track.has_position || !observation.is_active) continue;
        if (before != nullptr) distances.push_back(SquaredDistance(DescriptorOf(*before), DescriptorOf(observation)));
        before = &observation;
      }
    }
    if (distances.empty()) return 0;
    const auto at =
        distances.begin() + static_cast<std::ptrdiff_t>(kUsualShare * static_cast<double>(distances.size()));
    std::nth_element(distances.begin(), at, distances.end());
    return *at;
  }

  std::vector<Look> LooksAt(const SfmTrack& track) const {
    std::vector<Look> looks;
    for (const SfmObservation& observation : state_.ObservationsOf(track)) {
      if (!observation.is_active) continue;
      const double depth = (*state_.poses[observation.view] * track.position).z();
      looks.push_back({&observation, (centres_[observation.view] - track.position).normalized(),
                       depth * KeypointOf(observation).scale_px});
    }
    return looks;
  }

  bool Observes(const SfmTrack& track, int view) const {
    const auto observations = state_.ObservationsOf(track);
    return std::any_of(observations.begin(), observations.end(),
                       [view](const SfmObservation& observation) { return observation.view == view; });
  }

  /// Nothing when none looks from near enough.
  static const Look* NearestLook(const std::vector<Look>& looks, const Eigen::Vector3d& direction) {
    const Look* nearest = nullptr;
    double best = kMaxTurnCosine;
    for (const Look& look : looks) {
      const double cosine = look.direction.dot(direction);
      if (cosine > best) best = cosine, nearest = &look;
    }
    return nearest;
  }

  bool IsStatic(int view, std::uint32_t keypoint) const {
    return !is_static_.empty() && !is_static_[view].empty() && is_static_[view][keypoint] != 0;
  }

  float ReachPx(float scale_px) const { return static_cast<float>(max_error_px_) * ExpectedSigmaPx(scale_px); }

  void Offer(std::int32_t track, std::int32_t view, const Look& nearest, std::vector<CompletionLink>& links) const {
    const Eigen::Vector3d point = *state_.poses[view] * state_.tracks[track].position;
    const std::optional<Eigen::Vector2d> pixel = state_.camera.Project(point);
    if (!pixel) return;
    const Eigen::Vector2f place = pixel->cast<float>();
    const double expected_scale = nearest.size / point.z();
    const float reach = ReachPx(static_cast<float>(kMaxScaleRatio * expected_scale));
    CompletionLink best{track, {view, 0}, max_squared_distance_ + 1};
    grids_[view].VisitBox(place.array() - reach, place.array() + reach, [&](std::uint32_t k) {
      const Keypoint& keypoint = features_[view].keypoints[k];
      const double ratio = keypoint.scale_px / expected_scale;
      if (ratio > kMaxScaleRatio || ratio * kMaxScaleRatio < 1 || IsStatic(view, k)) return;
      if (std::hypot(keypoint.x - place.x(), keypoint.y - place.y()) > ReachPx(keypoint.scale_px)) return;
      const std::int32_t distance = SquaredDistance(DescriptorOf(*nearest.observation), features_[view].Descriptor(k));
      if (std::tie(distance, k) >= std::tie(best.squared_distance, best.feature.keypoint)) return;
      best.squared_distance = distance;
      best.feature.keypoint = k;
    });
    if (best.squared_distance <= max_squared_distance_) links.push_back(best);
  }

  std::span<const Features> features_;
  const std::vector<std::vector<std::uint8_t>>& is_static_;
  double max_error_px_;
  const SfmState& state_;
  std::vector<KeypointGrid> grids_;
  std::vector<Eigen::Vector3d> centres_;
  std::int32_t max_squared_distance_ = 0;
};

}  // namespace

Result<std::vector<CompletionLink>> FindCompletionLinks(std::span<const Features> features,
                                                        const std::vector<std::vector<std::uint8_t>>& is_static,
                                                        double max_error_px, const RunContext& context,
                                                        const SfmState& state) {
  const LinkSearch search(features, is_static, max_error_px, state);
  const std::size_t chunks = (state.tracks.size() + kTracksAChunk - 1) / kTracksAChunk;
  std::vector<std::vector<CompletionLink>> found(chunks);
  DRUPE_RETURN_IF_ERROR(ParallelFor(context, chunks, [&](std::size_t chunk) {
    const std::size_t end = std::min(state.tracks.size(), (chunk + 1) * kTracksAChunk);
    for (std::size_t t = chunk * kTracksAChunk; t < end; ++t) search.Search(static_cast<std::int32_t>(t), found[chunk]);
  }));
  std::vector<CompletionLink> links;
  for (const auto& some : found) links.insert(links.end(), some.begin(), some.end());
  std::stable_sort(links.begin(), links.end(), [](const CompletionLink& a, const CompletionLink& b) {
    return a.squared_distance < b.squared_distance;
  });
  return links;
}

}  // namespace drupe
