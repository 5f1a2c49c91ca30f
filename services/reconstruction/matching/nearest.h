#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "scene/features.h"

namespace drupe {

/// The nearest descriptor of another picture. Distances are squared Euclidean, between descriptors as stored.
struct Nearest {
  std::int32_t index = -1;  ///< -1: the other picture has no descriptor
  std::int32_t squared_distance = 0;
  std::int32_t second_squared_distance = 0;  ///< of the runner-up; the largest number when there is none

  /// The ratio test of Lowe 2004, section 7.1.
  bool Passes(double max_ratio) const {
    return index >= 0 && squared_distance < max_ratio * max_ratio * second_squared_distance;
  }
};

/// Descriptors of one picture laid out for the comparison of all with all.
struct PackedDescriptors {
  static constexpr int kBlock = 16;  ///< descriptors side by side in `blocks`

  PackedDescriptors() = default;
  /// The descriptors named by `subset`, in its order.
  PackedDescriptors(const Features& features, std::span<const std::uint32_t> subset);

  std::size_t size() const { return squared_norms.size(); }
  std::size_t BlockCount() const { return offsets.size() / kBlock; }

  std::vector<std::int8_t> rows;            ///< a row a descriptor: value - 128
  std::vector<std::uint8_t> blocks;         ///< [block][value / 4][descriptor of the block][value % 4]
  std::vector<std::int32_t> offsets;        ///< per descriptor of the blocks: 128 * sum(b) - b.b / 2
  std::vector<std::int32_t> squared_norms;  ///< b.b
};

/// For each of `queries`, indices into `from`, the nearest descriptors of `to`. Exact: every one is compared.
std::vector<Nearest> FindNearest(const PackedDescriptors& from, std::span<const std::uint32_t> queries,
                                 const PackedDescriptors& to);

}  // namespace drupe
