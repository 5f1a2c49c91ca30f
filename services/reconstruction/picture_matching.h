#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "base/json.h"
#include "base/run_context.h"
#include "base/status.h"
#include "reconstruction/matching/matching.h"
#include "reconstruction/matching/set_matcher.h"
#include "reconstruction/pipeline.h"
#include "scene/features.h"
#include "scene/view_graph.h"

namespace drupe {

/// Pairs of pictures with a memory: matches them one by one while pictures arrive, and leaves in the cache of the input
/// what RunMatching then need not do. What is kept follows from the digests of the pictures that tell it (the two, and
/// those with which they are compared for static features), their places in the set, the calibration, the options and
/// the seed, so that it is, bit by bit, what RunMatching would find.
class PictureMatching {
 public:
  /// `pictures`: those of a set that can be used, or all that have come so far, in their order. `input` has a
  /// calibration, since a guessed camera follows from all pictures; its images are not looked at. All must outlive it.
  PictureMatching(std::span<const SourceImage> pictures, const ReconstructionInput& input,
                  const ReconstructionOptions& options, const RunContext& context);

  /// What the cache holds of a pair; nothing where it holds none. Thread-safe.
  std::optional<KnownPair> Known(const ImagePair& pair) const;

  /// Matches picture `view` with each of `others`, as far as the cache does not hold that; does nothing for pictures of
  /// which nothing is kept. The set has kComparedForStatic pictures at least. Errors: those of reading and RunFeatures;
  /// `cancelled`.
  Status MatchAhead(std::size_t view, std::span<const std::size_t> others) const;

 private:
  class Looked;
  /// Nothing when what follows from one of the pictures is not kept.
  std::optional<Json> StaticParameters(std::size_t view) const;
  std::optional<std::string> PairKey(const ImagePair& pair) const;
  Result<std::vector<std::uint8_t>> FindStatic(std::size_t view, const Features& features) const;

  const std::span<const SourceImage> pictures_;
  const ReconstructionInput& input_;
  const ReconstructionOptions& options_;
  const RunContext& context_;
  const SetMatcher matcher_;
  const Json option_json_;
  const std::string common_;  ///< digest of what the keys of all pairs have in common
};

}  // namespace drupe
