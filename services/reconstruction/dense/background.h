#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "image/image.h"
#include "reconstruction/dense/region_of_interest.h"
#include "reconstruction/dense/view_pyramid.h"
#include "scene/sparse_model.h"

namespace drupe::dense {

/// The colours of the background: those that are frequent along the edges of the pictures and rare where tracks were
/// found; before black cloth also all that are nearly as black, which its folds are, tracks or not. Empty, so that
/// nothing counts as background, when the two cannot be told apart.
class BackgroundColours {
 public:
  BackgroundColours() = default;

  /// Learnt in Lab from the rims of the views' crops and from the pixels of the tracks in the region.
  static BackgroundColours Learn(const SparseModel& model, const RegionOfInterest& region,
                                 const std::vector<DenseView>& views);

  bool Empty() const { return table_.empty(); }
  /// sRGB bytes of one pixel. Not to be called when Empty().
  bool Contains(const std::uint8_t* rgb) const;

 private:
  std::vector<std::uint8_t> table_;  ///< a flag for every sRGB colour at five bits a channel
};

}  // namespace drupe::dense
