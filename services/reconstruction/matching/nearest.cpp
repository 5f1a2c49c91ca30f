#include "reconstruction/matching/nearest.h"

#include <algorithm>
#include <array>
#include <limits>

#include "reconstruction/matching/nearest_scan.h"

namespace drupe {
namespace {

constexpr int kDimension = Features::kDimension;
constexpr int kBlock = PackedDescriptors::kBlock;
/// Offset of a block's places that hold no descriptor: no score reaches a real one's from here.
constexpr std::int32_t kAbsent = std::numeric_limits<std::int32_t>::min() / 2;

/// The best two of all lanes of query q. Equal scores: the lower index wins, so that the layout does not show.
Nearest Reduce(const LaneBest& lanes, int q, std::int32_t squared_norm) {
  std::int64_t best = kAbsent, second = kAbsent;
  std::int32_t index = -1;
  for (int l = 0; l < kBlock; ++l) {
    const std::int32_t candidate = lanes.block[q][l] * kBlock + l;
    const std::int64_t score = lanes.best[q][l];
    if (score > best || (score == best && candidate < index)) {
      second = std::max(best, second);
      best = score;
      index = candidate;
    } else {
      second = std::max(second, score);
    }
    second = std::max<std::int64_t>(second, lanes.second[q][l]);
  }
  const auto distance = [squared_norm](std::int64_t score) {
    if (score < kAbsent / 2) return std::numeric_limits<std::int32_t>::max();
    return static_cast<std::int32_t>(std::max<std::int64_t>(0, squared_norm - 2 * score));
  };
  return {best < kAbsent / 2 ? -1 : index, distance(best), distance(second)};
}

}  // namespace

PackedDescriptors::PackedDescriptors(const Features& features, std::span<const std::uint32_t> subset) {
  const std::size_t block_count = (subset.size() + kBlock - 1) / kBlock;
  rows.resize(subset.size() * kDimension);
  blocks.resize(block_count * kBlock * kDimension);
  offsets.assign(block_count * kBlock, kAbsent);
  squared_norms.resize(subset.size());
  for (std::size_t i = 0; i < subset.size(); ++i) {
    const std::uint8_t* descriptor = features.Descriptor(subset[i]);
    std::uint8_t* block = blocks.data() + i / kBlock * kBlock * kDimension + i % kBlock * 4;
    std::int32_t sum = 0, squares = 0;
    for (int k = 0; k < kDimension; ++k) {
      rows[i * kDimension + k] = static_cast<std::int8_t>(descriptor[k] - 128);
      block[k / 4 * 4 * kBlock + k % 4] = descriptor[k];
      sum += descriptor[k];
      squares += descriptor[k] * descriptor[k];
    }
    offsets[i] = 128 * sum - squares / 2;
    squared_norms[i] = squares;
  }
}

std::vector<Nearest> FindNearest(const PackedDescriptors& from, std::span<const std::uint32_t> queries,
                                 const PackedDescriptors& to) {
  std::vector<Nearest> nearest(queries.size());
  alignas(64) std::array<std::int8_t, kQueryGroup * kDimension> group{};
  LaneBest lanes;
  for (std::size_t first = 0; first < queries.size(); first += kQueryGroup) {
    const std::size_t count = std::min<std::size_t>(kQueryGroup, queries.size() - first);
    for (std::size_t q = 0; q < count; ++q) {
      std::copy_n(from.rows.data() + std::size_t{queries[first + q]} * kDimension, kDimension,
                  group.data() + q * kDimension);
    }
    ScanBlocks(group.data(), to, lanes);
    for (std::size_t q = 0; q < count; ++q) {
      nearest[first + q] = Reduce(lanes, static_cast<int>(q), from.squared_norms[queries[first + q]]);
    }
  }
  return nearest;
}

}  // namespace drupe
