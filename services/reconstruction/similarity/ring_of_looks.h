#pragma once

#include <cmath>
#include <cstdint>
#include <random>
#include <vector>

#include "scene/features.h"

namespace drupe {

/// For tests: random numbers that are the same on every machine.
class Random {
 public:
  explicit Random(std::uint64_t seed) : engine_(seed) {}
  double Uniform() { return static_cast<double>(engine_() >> 11) * 0x1p-53; }
  float Normal(double mean, double sigma) {
    const double radius = std::sqrt(-2 * std::log(1 - Uniform()));
    return static_cast<float>(mean + sigma * radius * std::cos(6.283185307179586 * Uniform()));
  }

 private:
  std::mt19937_64 engine_;
};

/// For tests: pictures along a ring: each shows a window of a long row of looks, so neighbours share most.
inline std::vector<Features> Ring(int count) {
  Random random(6);
  std::vector<std::vector<std::uint8_t>> looks(count * 20);
  for (auto& look : looks) {
    look.resize(Features::kDimension);
    for (std::uint8_t& value : look) value = static_cast<std::uint8_t>(78 * random.Uniform());
  }
  std::vector<Features> pictures(count);
  for (int i = 0; i < count; ++i) {
    for (int k = 0; k < 120; ++k) {
      const auto& look = looks[(i * 20 + k) % looks.size()];
      pictures[i].keypoints.push_back({});
      pictures[i].descriptors.insert(pictures[i].descriptors.end(), look.begin(), look.end());
    }
  }
  return pictures;
}

}  // namespace drupe
