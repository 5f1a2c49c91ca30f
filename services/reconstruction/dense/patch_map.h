#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "reconstruction/dense/view_pyramid.h"

namespace drupe::dense {

/// A patch of one reference view at one level: the plane 1/z = w + wu du + wv dv about the cell's pixel.
struct PatchCell {
  float w = 0, wu = 0, wv = 0;
  float bend = 0;           ///< half the Laplacian of 1/z, a pixel squared; known after FitSurface
  float ncc = 0;            ///< mean over the agreeing views; 0: the cell is empty
  float sigma = 0;          ///< standard uncertainty of w, in frame units (pixels of parallax)
  std::uint32_t views = 0;  ///< agreeing neighbours, bit k for the k-th

  bool Filled() const { return ncc > 0; }
};

/// A first guess of a patch.
struct PatchGuess {
  int cell = 0;  ///< index in PatchMap::cells
  PatchCell plane;
};

/// The patches of one reference view at one level, one a cell of csize x csize pixels.
struct PatchMap {
  int level = 0, csize = 1;
  int cols = 0, rows = 0;
  float unit = 1;                ///< RefinerFrame::unit
  std::vector<PatchCell> cells;  ///< row-major

  PatchMap() = default;
  PatchMap(int level, int csize, int width, int height, float unit);

  PatchCell& At(int col, int row) { return cells[static_cast<std::size_t>(row) * cols + col]; }
  const PatchCell& At(int col, int row) const { return cells[static_cast<std::size_t>(row) * cols + col]; }
  bool Holds(int col, int row) const { return col >= 0 && row >= 0 && col < cols && row < rows; }
  /// The pixel of a cell, in its level.
  int Pixel(int cell) const { return cell * csize + csize / 2; }
  /// The cell that holds a pixel; may lie outside the map.
  int CellOf(double pixel) const;
};

/// A patch in the world.
struct SurfaceElement {
  Eigen::Vector3d position = Eigen::Vector3d::Zero();
  Eigen::Vector3d normal = Eigen::Vector3d::UnitZ();  ///< unit length, towards the reference
};

/// The plane through pixel (u, v) of a level as a point and normal of the world.
SurfaceElement ToWorld(const DenseView& view, const LevelCamera& camera, double u, double v, const PatchCell& plane);

/// The reverse: the plane of an element in the pixels of a level; w <= 0 when it cannot be seen.
PatchCell FromWorld(const DenseView& view, const LevelCamera& camera, const SurfaceElement& element);

}  // namespace drupe::dense
