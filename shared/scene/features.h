#pragma once

#include <cstdint>
#include <vector>

namespace drupe {

/// A SIFT keypoint (Lowe 2004), in pixels of the full picture, pixel centres at integers.
struct Keypoint {
  float x = 0, y = 0;
  float scale_px = 0;         ///< sigma of the Gaussian at which it was found
  float orientation_rad = 0;  ///< [-pi, pi), image x to y
  float response = 0;         ///< |difference of Gaussians| at the extremum
};

/// The local features of one picture.
struct Features {
  static constexpr int kDimension = 128;
  std::vector<Keypoint> keypoints;
  /// keypoints.size() x 128, row-major. RootSIFT (Arandjelovic & Zisserman 2012): the square root of the L1-normalised
  /// histogram, times 512, rounded and clamped to 0..255; the L2 norm is about 512.
  std::vector<std::uint8_t> descriptors;

  std::size_t size() const { return keypoints.size(); }
  const std::uint8_t* Descriptor(std::size_t i) const { return descriptors.data() + i * kDimension; }
};

}  // namespace drupe
