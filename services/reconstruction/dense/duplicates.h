#pragma once

#include <cstdint>
#include <vector>

#include "scene/point_cloud.h"

namespace drupe::dense {

/// A point near the border between the strips of surface that two views own, where both may have measured it.
struct SeamPoint {
  std::uint32_t index = 0;  ///< in the cloud
  int owner = 0;            ///< the view that measured it
  float margin = 1;         ///< the owner's score over that of the best other view
  float spacing = 0;        ///< from point to point of its view, in the cloud's unit
};

/// Which points of a cloud of `size` points stay once the duplicates along the seams are removed (the consistency
/// comparison of paper 3.1.3): in descending order of margin, a point stays unless a point of another view stays within
/// three quarters of its spacing. So strips that overlap neither gape nor double. Does not depend on the order of
/// `seam`.
std::vector<std::uint8_t> MarkDistinct(const PointCloud& cloud, std::vector<SeamPoint> seam);

}  // namespace drupe::dense
