#include "reconstruction/sparse/track_completion.h"

#include <algorithm>
#include <numeric>
#include <utility>

#include "reconstruction/sparse/completion_links.h"

namespace drupe {
namespace {

constexpr std::int32_t kNobody = -1;

/// The tracks while they grow and join.
class TrackSets {
 public:
  TrackSets(std::span<const Features> features, double max_error_px, SfmState& state)
      : features_(features), max_error_px_(max_error_px), state_(state), parent_(state.tracks.size()) {
    std::iota(parent_.begin(), parent_.end(), 0);
    for (const Features& view : features) owner_.emplace_back(view.size(), kNobody);
    for (const SfmTrack& track : state.tracks) {
      const auto observations = state.ObservationsOf(track);
      members_.emplace_back(observations.begin(), observations.end());
      for (const SfmObservation& observation : observations) {
        if (observation.is_active) Own({observation.view, observation.keypoint}, observation.track);
      }
    }
  }

  void Follow(const CompletionLink& link) {
    const std::int32_t track = Root(link.track), owner = owner_[link.feature.view][link.feature.keypoint];
    if (owner == kNobody) {
      Add(link.feature, track);
    } else if (Root(owner) != track) {
      Merge(track, Root(owner));
    }
  }

  /// Puts the sets back into the state.
  CompletionCounts Store() {
    SfmState& state = state_;
    std::vector<SfmTrack> before = std::move(state.tracks);
    state.tracks.clear();
    state.observations.clear();
    for (auto& seen : state.view_observations) seen.clear();
    for (std::size_t t = 0; t < before.size(); ++t) {
      if (parent_[t] == static_cast<std::int32_t>(t)) StoreTrack(before[t], static_cast<std::int32_t>(t));
    }
    return counts_;
  }

 private:
  std::int32_t Root(std::int32_t track) {
    while (parent_[track] != track) track = parent_[track] = parent_[parent_[track]];
    return track;
  }

  /// A place of several orientations, which follow one another, has one owner.
  void Own(const FeatureRef& feature, std::int32_t track) {
    const std::vector<Keypoint>& keypoints = features_[feature.view].keypoints;
    const auto is_same = [](const Keypoint& a, const Keypoint& b) {
      return a.x == b.x && a.y == b.y && a.scale_px == b.scale_px;
    };
    const Keypoint& here = keypoints[feature.keypoint];
    std::vector<std::int32_t>& owner = owner_[feature.view];
    owner[feature.keypoint] = track;
    for (std::size_t k = feature.keypoint + 1; k < keypoints.size() && is_same(keypoints[k], here); ++k) {
      owner[k] = track;
    }
    for (std::size_t k = feature.keypoint; k > 0 && is_same(keypoints[k - 1], here); --k) owner[k - 1] = track;
  }

  bool Sees(std::int32_t track, int view) const {
    return std::any_of(members_[track].begin(), members_[track].end(),
                       [view](const SfmObservation& o) { return o.is_active && o.view == view; });
  }

  bool Explains(const SfmTrack& track, const SfmObservation& o) const {
    return ErrorPx(*state_.poses[o.view], o.measured, track.position) <= max_error_px_ * o.sigma_px;
  }

  void Add(const FeatureRef& feature, std::int32_t track) {
    if (Sees(track, feature.view)) return;
    SfmObservation observation =
        MakeObservation(state_.camera, feature, features_[feature.view].keypoints[feature.keypoint]);
    if (!Explains(state_.tracks[track], observation)) return;  // it has joined another since it was projected
    observation.is_active = true;
    members_[track].push_back(observation);
    Own(feature, track);
    ++counts_.added;
  }

  std::ptrdiff_t CountActive(std::int32_t track) const {
    return std::count_if(members_[track].begin(), members_[track].end(),
                         [](const SfmObservation& o) { return o.is_active; });
  }

  /// Whether the point of `other` explains all active observations of a track, none of them in a view of `other`.
  bool CanJoin(std::int32_t track, std::int32_t other) const {
    return std::all_of(members_[track].begin(), members_[track].end(), [&](const SfmObservation& o) {
      return !o.is_active || (!Sees(other, o.view) && Explains(state_.tracks[other], o));
    });
  }

  void Merge(std::int32_t a, std::int32_t b) {
    if (CountActive(a) < CountActive(b) || (CountActive(a) == CountActive(b) && b < a)) std::swap(a, b);
    if (!CanJoin(b, a)) return;
    members_[a].insert(members_[a].end(), members_[b].begin(), members_[b].end());
    members_[b].clear();
    parent_[b] = a;
    ++counts_.merged;
  }

  /// What a set keeps: one observation a view, the active one, and none of a feature that another track now has.
  std::vector<SfmObservation> Kept(std::int32_t set) {
    std::vector<SfmObservation> kept;
    for (const SfmObservation& o : members_[set]) {
      const std::int32_t owner = owner_[o.view][o.keypoint];
      if (o.is_active || (owner == kNobody && !Sees(set, o.view))) kept.push_back(o);
    }
    std::stable_sort(kept.begin(), kept.end(),
                     [](const SfmObservation& a, const SfmObservation& b) { return a.view < b.view; });
    kept.erase(std::unique(kept.begin(), kept.end(),
                           [](const SfmObservation& a, const SfmObservation& b) { return a.view == b.view; }),
               kept.end());
    return kept;
  }

  void StoreTrack(SfmTrack track, std::int32_t set) {
    const std::vector<SfmObservation> kept = Kept(set);
    if (kept.size() < 2) return;
    track.begin = state_.observations.size();
    for (SfmObservation observation : kept) {
      observation.track = static_cast<std::int32_t>(state_.tracks.size());
      state_.view_observations[observation.view].push_back(state_.observations.size());
      state_.observations.push_back(observation);
    }
    track.end = state_.observations.size();
    state_.tracks.push_back(track);
  }

  std::span<const Features> features_;
  double max_error_px_;
  SfmState& state_;
  std::vector<std::int32_t> parent_;
  std::vector<std::vector<SfmObservation>> members_;  ///< of a root
  std::vector<std::vector<std::int32_t>> owner_;      ///< per view and keypoint: the track that has it active
  CompletionCounts counts_;
};

bool HaveDescriptors(std::span<const Features> features) {
  return std::all_of(features.begin(), features.end(), [](const Features& view) {
    return view.descriptors.size() == view.size() * Features::kDimension;
  });
}

}  // namespace

Result<CompletionCounts> CompleteTracks(std::span<const Features> features,
                                        const std::vector<std::vector<std::uint8_t>>& is_static, double max_error_px,
                                        const RunContext& context, SfmState& state) {
  if (!HaveDescriptors(features)) return CompletionCounts{};
  DRUPE_ASSIGN_OR_RETURN(const std::vector<CompletionLink> links,
                         FindCompletionLinks(features, is_static, max_error_px, context, state));
  TrackSets sets(features, max_error_px, state);
  for (const CompletionLink& link : links) sets.Follow(link);
  return sets.Store();
}

}  // namespace drupe
