#include "reconstruction/matching/set_matcher.h"

#include "reconstruction/matching/pair_matcher.h"
#include "reconstruction/matching/uncalibrated_matcher.h"

namespace drupe {
namespace {

/// Different for every pair, the same in every run.
std::uint64_t SeedOf(std::uint64_t seed, const ImagePair& pair) {
  return seed * 0x9E3779B97F4A7C15u + static_cast<std::uint64_t>(pair.first) * 0x100000001B3u +
         static_cast<std::uint64_t>(pair.second);
}

}  // namespace

SetMatcher::SetMatcher(const PinholeCamera& camera, bool camera_is_guess, const MatchingOptions& options,
                       std::uint64_t seed)
    : camera_(camera), camera_is_guess_(camera_is_guess), options_(options), seed_(seed) {}

PreparedPicture SetMatcher::Prepare(const Features& picture, const std::vector<std::uint8_t>& is_static) const {
  return PreparedPicture(picture, is_static, camera_, options_.exhaustive_features);
}

std::optional<TwoViewMatches> SetMatcher::Match(const PreparedPicture& first, const PreparedPicture& second,
                                                const ImagePair& pair) const {
  const double focal_px = 0.5 * (camera_.fx + camera_.fy);
  const auto match = camera_is_guess_ ? MatchUncalibratedPair : MatchPair;
  return match(first, second, pair, focal_px, options_, SeedOf(seed_, pair));
}

}  // namespace drupe
