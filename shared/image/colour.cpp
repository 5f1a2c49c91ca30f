#include "image/colour.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace drupe {
namespace {

constexpr int kRootSteps = 4096;

struct Tables {
  std::array<float, 256> linear;
  std::array<float, kRootSteps + 2> root;  ///< the f of CIE L*a*b* at i / kRootSteps

  Tables() {
    for (int i = 0; i < 256; ++i) {
      const double v = i / 255.0;
      linear[i] = static_cast<float>(v <= 0.04045 ? v / 12.92 : std::pow((v + 0.055) / 1.055, 2.4));
    }
    for (int i = 0; i < kRootSteps + 2; ++i) {
      const double t = static_cast<double>(i) / kRootSteps;
      root[i] = static_cast<float>(t > 216.0 / 24389 ? std::cbrt(t) : (24389.0 / 27 * t + 16) / 116);
    }
  }

  float Root(float t) const {
    const float place = std::clamp(t, 0.0f, 1.0f) * kRootSteps;
    const int i = static_cast<int>(place);
    return root[i] + (place - static_cast<float>(i)) * (root[i + 1] - root[i]);
  }
};

const Tables& GetTables() {
  static const Tables tables;
  return tables;
}

}  // namespace

float LinearFromSrgb(std::uint8_t value) {
  return GetTables().linear[value];
}

Eigen::Vector3f LabFromLinear(const Eigen::Vector3f& linear) {
  const Tables& tables = GetTables();
  const float r = linear[0], g = linear[1], b = linear[2];
  // The rows of the sRGB matrix, divided by the white point D65.
  const float x = tables.Root(0.43395298f * r + 0.37620998f * g + 0.18983705f * b);
  const float y = tables.Root(0.21267286f * r + 0.71515217f * g + 0.07217497f * b);
  const float z = tables.Root(0.01775658f * r + 0.10946931f * g + 0.87277411f * b);
  return {116 * y - 16, 500 * (x - y), 200 * (y - z)};
}

Eigen::Vector3f LabFromSrgb(const Rgb8& colour) {
  return LabFromLinear(LinearFromSrgb(colour));
}

}  // namespace drupe
