#pragma once

#include <cstdint>
#include <optional>

#include "reconstruction/matching/matching.h"
#include "reconstruction/matching/prepared_picture.h"
#include "scene/view_graph.h"

namespace drupe {

/// As MatchPair, for a lens that is a guess (MatchingOptions::guessed_lens). With a fundamental matrix, matches are
/// verified and further ones guided by it within `max_error_px`; the relative pose that the graph wants is then that of
/// an essential matrix with the guess, within three times as much. Where there is none, the matches stay and the pair
/// is not `calibrated`.
std::optional<TwoViewMatches> MatchUncalibratedPair(const PreparedPicture& first, const PreparedPicture& second,
                                                    ImagePair pair, double focal_px, const MatchingOptions& options,
                                                    std::uint64_t seed);

}  // namespace drupe
