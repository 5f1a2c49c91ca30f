#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <utility>
#include <vector>

#include "reconstruction/dense/background.h"

namespace drupe::dense {

/// What a picture shows of the background: the region of background colours that reaches its rim, in blocks of pixels.
/// A highlight or a dark spot on the fruit may have the background's colour, but the fruit surrounds it.
class Silhouette {
 public:
  Silhouette() = default;  ///< nothing is background
  Silhouette(const RgbImage& picture, const BackgroundColours& colours);
  /// The one that has these: pixels a block, blocks, and a flag a block, cols x rows.
  Silhouette(int block, int cols, int rows, std::vector<std::uint8_t> background)
      : block_(block), cols_(cols), rows_(rows), background_(std::move(background)) {}

  /// For a pixel of the finest level; false outside the picture.
  bool IsBackground(double u, double v) const;

  int block() const { return block_; }
  int cols() const { return cols_; }
  int rows() const { return rows_; }
  const std::vector<std::uint8_t>& background() const { return background_; }

 private:
  int block_ = 1, cols_ = 0, rows_ = 0;
  std::vector<std::uint8_t> background_;  ///< [row * cols + col]
};

/// One silhouette a view. Those of views whose background is not recognised call nothing background.
std::vector<Silhouette> FindSilhouettes(const SparseModel& model, const RegionOfInterest& region,
                                        const std::vector<DenseView>& views);

/// True when a point lies outside the fruit's outline in too many of the views: the visual hull (Laurentini 1994) with
/// some tolerance for wrong silhouettes. At most about 18 views are asked, spread evenly.
bool IsOutsideHull(const std::vector<DenseView>& views, const std::vector<Silhouette>& silhouettes,
                   const Eigen::Vector3d& point);

}  // namespace drupe::dense
