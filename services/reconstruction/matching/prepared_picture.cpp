#include "reconstruction/matching/prepared_picture.h"

#include <algorithm>

namespace drupe {

PreparedPicture::PreparedPicture(const Features& picture, const std::vector<std::uint8_t>& is_static,
                                 const PinholeCamera& camera, int exhaustive_features)
    : features(&picture) {
  for (std::uint32_t i = 0; i < picture.size(); ++i) {
    if (is_static[i] != 0) continue;
    kept.push_back(i);
    places.push_back(camera.NormalisedFromPixel({picture.keypoints[i].x, picture.keypoints[i].y}));
  }
  std::size_t packed_count = kept.size();
  if (exhaustive_features > 0) packed_count = std::min<std::size_t>(packed_count, exhaustive_features);
  packed = PackedDescriptors(picture, std::span(kept).first(packed_count));
}

}  // namespace drupe
