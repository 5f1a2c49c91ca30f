#pragma once

#include <bit>
#include <cstddef>
#include <string>

namespace drupe {

static_assert(std::endian::native == std::endian::little, "PLY files are written as memory lies");

/// The bytes of `count` values at the end of `out`.
template <typename T>
void PutValues(const T* values, std::size_t count, std::string* out) {
  out->append(reinterpret_cast<const char*>(values), count * sizeof(T));
}

}  // namespace drupe
