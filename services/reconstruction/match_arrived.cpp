#include "reconstruction/match_arrived.h"

#include <algorithm>
#include <cstddef>
#include <set>
#include <vector>

#include "reconstruction/arrived_picture.h"
#include "reconstruction/matching/static_features.h"
#include "reconstruction/picture_matching.h"

namespace drupe {
namespace {

/// The pictures right before `place` in the order of the set.
std::set<std::size_t> Before(std::size_t place, const ReconstructionOptions& options) {
  const std::size_t window = std::min(place, static_cast<std::size_t>(options.clusters.sequence_window));
  std::set<std::size_t> before;
  for (std::size_t step = 1; step <= window; ++step) before.insert(place - step);
  return before;
}

Status MatchWith(const PictureMatching& matching, std::size_t place, const std::set<std::size_t>& others) {
  return matching.MatchAhead(place, std::vector<std::size_t>(others.begin(), others.end()));
}

/// The first pictures, for which it was too early when they came.
Status MatchFront(const PictureMatching& matching, const ReconstructionOptions& options) {
  if (matching.Known({0, 1})) return Status::Ok();
  // The first pair comes last: it says that all of them are there.
  for (std::size_t place = kComparedForStatic; place-- > 1;) {
    DRUPE_RETURN_IF_ERROR(MatchWith(matching, place, Before(place, options)));
  }
  return Status::Ok();
}

}  // namespace

bool IsTimeToMatch(const SourceImage& arrived, const ReconstructionInput& set) {
  const std::size_t place = PlaceOf(arrived, set.images);
  return set.calibration && place < set.images.size() && place + 1 >= kComparedForStatic;
}

Result<int> MatchArrived(const SourceImage& arrived, std::span<const std::string> alike, const ReconstructionInput& set,
                         const ReconstructionOptions& options, const RunContext& context) {
  if (!IsTimeToMatch(arrived, set)) return 0;
  const std::size_t place = PlaceOf(arrived, set.images);
  const PictureMatching matching(set.images, set, options, context);
  DRUPE_RETURN_IF_ERROR(MatchFront(matching, options));
  std::set<std::size_t> others = Before(place, options);
  for (std::size_t i = 0; i < set.images.size(); ++i) {
    if (std::find(alike.begin(), alike.end(), set.images[i].name) != alike.end()) others.insert(i);
  }
  others.erase(place);
  DRUPE_RETURN_IF_ERROR(MatchWith(matching, place, others));
  return static_cast<int>(others.size());
}

}  // namespace drupe
