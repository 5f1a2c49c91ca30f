#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

namespace drupe {

using Rgb8 = Eigen::Matrix<std::uint8_t, 3, 1>;  ///< sRGB, 0..255

/// Linear light, 0..1, of an sRGB value (IEC 61966-2-1).
float LinearFromSrgb(std::uint8_t value);
inline Eigen::Vector3f LinearFromSrgb(const Rgb8& colour) {
  return {LinearFromSrgb(colour[0]), LinearFromSrgb(colour[1]), LinearFromSrgb(colour[2])};
}

/// CIE 1976 L*a*b* under D65 of an sRGB colour: L 0..100, a and b about -100..100. The cube root comes from a table;
/// the error is below 0.01.
Eigen::Vector3f LabFromSrgb(const Rgb8& colour);

/// The same of a colour in linear light.
Eigen::Vector3f LabFromLinear(const Eigen::Vector3f& linear);

}  // namespace drupe
