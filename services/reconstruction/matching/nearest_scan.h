#pragma once

#include <array>
#include <cstdint>

#include "reconstruction/matching/nearest.h"

namespace drupe {

/// Queries that are compared at once, so that a block of the other picture is loaded once for all of them.
constexpr int kQueryGroup = 8;

/// The best and second best score of each query, by place in the blocks: lane l speaks for the descriptors whose number
/// is l modulo PackedDescriptors::kBlock.
struct LaneBest {
  using Lanes = std::array<std::int32_t, PackedDescriptors::kBlock>;
  alignas(64) std::array<Lanes, kQueryGroup> best;
  alignas(64) std::array<Lanes, kQueryGroup> second;
  alignas(64) std::array<Lanes, kQueryGroup> block;  ///< the block in which `best` was found
};

/// Compares kQueryGroup rows (Features::kDimension values each, value - 128) with every descriptor of `to`. The score
/// of query a and descriptor b is a.b - b.b / 2: the larger, the nearer.
void ScanBlocks(const std::int8_t* queries, const PackedDescriptors& to, LaneBest& out);

}  // namespace drupe
