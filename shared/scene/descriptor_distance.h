#pragma once

#include <cstdint>

namespace drupe {

/// Squared distance of two descriptors of Features::kDimension values.
std::int32_t SquaredDistance(const std::uint8_t* a, const std::uint8_t* b);

}  // namespace drupe
