#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "geometry/pinhole_camera.h"
#include "reconstruction/matching/matching.h"
#include "reconstruction/matching/prepared_picture.h"
#include "scene/features.h"
#include "scene/view_graph.h"

namespace drupe {

/// The steps of RunMatching for the pairs of one set, one by one and in any order. Thread-safe.
class SetMatcher {
 public:
  /// As in RunMatching; options that pass their Check().
  SetMatcher(const PinholeCamera& camera, bool camera_is_guess, const MatchingOptions& options, std::uint64_t seed);

  /// `picture` must outlive what is prepared of it; `is_static` as FindStaticFeatures gives it.
  PreparedPicture Prepare(const Features& picture, const std::vector<std::uint8_t>& is_static) const;

  /// The verified matches of a pair, whose pictures are `first` and `second`; nothing when it fails. They depend on the
  /// places of the pair in its set too, by the random samples.
  std::optional<TwoViewMatches> Match(const PreparedPicture& first, const PreparedPicture& second,
                                      const ImagePair& pair) const;

 private:
  const PinholeCamera camera_;
  const bool camera_is_guess_;
  const MatchingOptions options_;
  const std::uint64_t seed_;
};

}  // namespace drupe
