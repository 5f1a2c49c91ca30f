#include "reconstruction/matching/tracks.h"

#include <algorithm>
#include <map>
#include <numeric>
#include <string>
#include <tuple>

namespace drupe {
namespace {

/// All keypoints of all views in one row, and the disjoint sets they form.
class TrackForest {
 public:
  explicit TrackForest(std::span<const Features> features) {
    starts_.push_back(0);
    for (const Features& view : features) starts_.push_back(starts_.back() + view.size());
    parent_.resize(starts_.back());
    std::iota(parent_.begin(), parent_.end(), std::size_t{0});
    members_.resize(parent_.size());
    for (std::size_t v = 0; v < features.size(); ++v) AddView(features[v], static_cast<std::int32_t>(v));
  }

  bool Has(std::int32_t view, std::uint32_t keypoint) const {
    return view >= 0 && static_cast<std::size_t>(view) + 1 < starts_.size() &&
           keypoint < starts_[view + 1] - starts_[view];
  }

  /// Joins the sets of two features, unless they hold different places of one view.
  void Join(const FeatureRef& a, const FeatureRef& b) {
    std::size_t keep = Root(IndexOf(a)), gone = Root(IndexOf(b));
    if (keep == gone || Conflict(members_[keep], members_[gone])) return;
    if (members_[keep].size() < members_[gone].size()) std::swap(keep, gone);
    parent_[gone] = keep;
    std::vector<FeatureRef> merged;
    std::merge(members_[keep].begin(), members_[keep].end(), members_[gone].begin(), members_[gone].end(),
               std::back_inserter(merged), ByView);
    members_[keep] = std::move(merged);
    members_[gone] = {};
  }

  /// Takes the sets of `min_length` features or more, in the order of their first features.
  std::vector<std::vector<FeatureRef>> Take(std::size_t min_length) {
    std::vector<std::vector<FeatureRef>> tracks;
    for (std::vector<FeatureRef>& set : members_) {
      if (set.size() >= min_length) tracks.push_back(std::move(set));
    }
    std::sort(tracks.begin(), tracks.end(), [](const auto& a, const auto& b) {
      return std::tie(a[0].view, a[0].keypoint) < std::tie(b[0].view, b[0].keypoint);
    });
    return tracks;
  }

 private:
  static bool ByView(const FeatureRef& a, const FeatureRef& b) { return a.view < b.view; }

  /// One set per place: the orientations of an extremum share that of the first.
  void AddView(const Features& view, std::int32_t v) {
    std::map<std::tuple<float, float, float>, std::size_t> first_at;
    for (std::uint32_t k = 0; k < view.size(); ++k) {
      const Keypoint& keypoint = view.keypoints[k];
      const std::size_t index = starts_[v] + k;
      const auto [at, is_new] = first_at.try_emplace({keypoint.x, keypoint.y, keypoint.scale_px}, index);
      parent_[index] = at->second;
      if (is_new) members_[index] = {{v, k}};
    }
  }

  static bool Conflict(const std::vector<FeatureRef>& a, const std::vector<FeatureRef>& b) {
    for (std::size_t i = 0, j = 0; i < a.size() && j < b.size();) {
      if (a[i].view == b[j].view) return true;
      a[i].view < b[j].view ? ++i : ++j;
    }
    return false;
  }

  std::size_t IndexOf(const FeatureRef& feature) const { return starts_[feature.view] + feature.keypoint; }

  std::size_t Root(std::size_t i) {
    while (parent_[i] != i) {
      parent_[i] = parent_[parent_[i]];
      i = parent_[i];
    }
    return i;
  }

  std::vector<std::size_t> starts_;               ///< per view, the index of its first keypoint
  std::vector<std::size_t> parent_;               ///< per keypoint
  std::vector<std::vector<FeatureRef>> members_;  ///< of a root: its set, ascending by view
};

/// The pairs, those with most matches first; their order in the graph decides between equals.
std::vector<const TwoViewMatches*> StrongestFirst(const MatchGraph& graph) {
  std::vector<const TwoViewMatches*> pairs;
  for (const TwoViewMatches& pair : graph.pairs) pairs.push_back(&pair);
  std::stable_sort(pairs.begin(), pairs.end(), [](const TwoViewMatches* a, const TwoViewMatches* b) {
    return a->matches.size() > b->matches.size();
  });
  return pairs;
}

}  // namespace

Status TrackOptions::Check() const {
  if (min_length >= 2) return Status::Ok();
  return InvalidArgument("invalid_option", "min_length must be 2 or more", "min_length");
}

Result<TrackList> RunTracks(const MatchGraph& graph, std::span<const Features> features, const TrackOptions& options,
                            const RunContext& context) {
  DRUPE_RETURN_IF_ERROR(options.Check());
  TrackForest forest(features);
  for (const TwoViewMatches* pair : StrongestFirst(graph)) {
    DRUPE_RETURN_IF_ERROR(context.CheckCancelled());
    for (const FeatureMatch& match : pair->matches) {
      if (!forest.Has(pair->pair.first, match.first) || !forest.Has(pair->pair.second, match.second)) {
        return InvalidArgument("invalid_match", "a match of views " + std::to_string(pair->pair.first) + " and " +
                                                    std::to_string(pair->pair.second) +
                                                    " names a keypoint that does not exist");
      }
      forest.Join({pair->pair.first, match.first}, {pair->pair.second, match.second});
    }
  }
  return TrackList{forest.Take(options.min_length)};
}

}  // namespace drupe
