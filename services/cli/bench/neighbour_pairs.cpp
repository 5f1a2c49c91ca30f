#include "cli/bench/neighbour_pairs.h"

#include <algorithm>
#include <set>
#include <utility>

namespace drupe {

std::vector<ImagePair> NeighbourPairs(int count, int window) {
  std::set<std::pair<int, int>> pairs;
  for (int image = 0; image < count; ++image) {
    for (int step = 1; step <= std::min(window, count - 1); ++step) {
      const int other = (image + step) % count;
      pairs.emplace(std::min(image, other), std::max(image, other));
    }
  }
  std::vector<ImagePair> list;
  for (const auto& [first, second] : pairs) list.push_back({first, second});
  return list;
}

}  // namespace drupe
