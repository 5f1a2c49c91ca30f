#pragma once

#include <cstddef>
#include <cstdint>

namespace drupe {

/// What is accepted from outside. Every number is checked before memory or time is spent on what it limits.
struct Limits {
  std::size_t max_request_bytes = std::size_t{2} << 30;  ///< a whole multipart request
  std::size_t max_image_bytes = std::size_t{64} << 20;   ///< one image file
  int max_image_side_px = 16384;                         ///< width or height
  std::int64_t max_image_pixels = 64'000'000;            ///< width times height
  int min_images = 3;                                    ///< an image set that can be reconstructed
  int max_images = 400;                                  ///< an image set
  int max_concurrent_uploads = 8;                        ///< requests with a body being read at once
};

}  // namespace drupe
