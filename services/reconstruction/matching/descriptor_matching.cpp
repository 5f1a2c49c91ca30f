#include "reconstruction/matching/descriptor_matching.h"

#include <algorithm>
#include <cstdint>
#include <numeric>
#include <span>

#include "reconstruction/matching/nearest.h"

namespace drupe {
namespace {

/// Features asked first, coarsest of all; a pair in which fewer than so many of them pass the ratio test is given up.
constexpr std::uint32_t kVanguard = 800;
constexpr std::ptrdiff_t kVanguardMinPassed = 4;

/// The nearest of each packed feature; cut short when the vanguard finds too little (Wu 2013, preemptive matching).
std::vector<Nearest> FindForward(const PreparedPicture& first, const PreparedPicture& second, double max_ratio) {
  std::vector<std::uint32_t> queries(first.packed.size());
  std::iota(queries.begin(), queries.end(), 0u);
  const std::size_t vanguard = std::min<std::size_t>(kVanguard, queries.size());
  std::vector<Nearest> nearest = FindNearest(first.packed, std::span(queries).first(vanguard), second.packed);
  const auto passed = std::count_if(nearest.begin(), nearest.end(),
                                    [max_ratio](const Nearest& candidate) { return candidate.Passes(max_ratio); });
  if (passed < kVanguardMinPassed) return nearest;
  const std::vector<Nearest> rest = FindNearest(first.packed, std::span(queries).subspan(vanguard), second.packed);
  nearest.insert(nearest.end(), rest.begin(), rest.end());
  return nearest;
}

}  // namespace

std::vector<FeatureMatch> MatchDescriptors(const PreparedPicture& first, const PreparedPicture& second,
                                           double max_ratio) {
  const std::vector<Nearest> forward = FindForward(first, second, max_ratio);
  // The way back is asked of the few that pass alone.
  std::vector<std::uint32_t> passed, partners;
  for (std::uint32_t i = 0; i < forward.size(); ++i) {
    if (!forward[i].Passes(max_ratio)) continue;
    passed.push_back(i);
    partners.push_back(static_cast<std::uint32_t>(forward[i].index));
  }
  const std::vector<Nearest> backward = FindNearest(second.packed, partners, first.packed);
  std::vector<FeatureMatch> matches;
  for (std::size_t k = 0; k < passed.size(); ++k) {
    if (backward[k].index == static_cast<std::int32_t>(passed[k])) {
      matches.push_back({passed[k], partners[k]});
    }
  }
  return matches;
}

}  // namespace drupe
