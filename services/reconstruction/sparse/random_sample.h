#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <utility>

namespace drupe {

/// SplitMix64 (Steele, Lea & Flood 2014): a seed gives the same numbers with every standard library.
class RandomSampler {
 public:
  explicit RandomSampler(std::uint64_t seed) : state_(seed) {}

  std::uint64_t Next() {
    std::uint64_t z = (state_ += 0x9e3779b97f4a7c15ULL);
    z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9ULL;
    z = (z ^ (z >> 27)) * 0x94d049bb133111ebULL;
    return z ^ (z >> 31);
  }

  /// `kCount` different indices below `size` >= kCount.
  template <std::size_t kCount>
  std::array<std::size_t, kCount> Distinct(std::size_t size) {
    std::array<std::size_t, kCount> picked{};
    for (std::size_t i = 0; i < kCount; ++i) {
      bool is_new = false;
      while (!is_new) {
        picked[i] = static_cast<std::size_t>(Next() % size);
        is_new = true;
        for (std::size_t k = 0; k < i; ++k) is_new = is_new && picked[k] != picked[i];
      }
    }
    return picked;
  }

 private:
  std::uint64_t state_;
};

}  // namespace drupe
