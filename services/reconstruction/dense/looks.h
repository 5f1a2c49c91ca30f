#pragma once

#include <Eigen/Core>
#include <array>
#include <vector>

#include "reconstruction/dense/level_context.h"

namespace drupe::dense {

constexpr int kMaxLooks = 1 + 16;

/// What one view shows of a point.
struct Look {
  int view = 0;
  float share = 0;  ///< of the best view's pixels per surface area, 0..1
  Eigen::Array3f log_colour = Eigen::Array3f::Zero();
};

struct Looks {
  std::array<Look, kMaxLooks> items;
  int count = 0;
};

/// Finds the views that show a point, and not something before it.
class LookCollector {
 public:
  /// `maps` are the patches of all views at the level of `context`; both must outlive the collector.
  LookCollector(const LevelContext& context, const std::vector<PatchMap>& maps);

  /// The looks of the point's owner and of its neighbours in their order, frontal ones first, those from aside only
  /// where there are few; without those that are saturated, and those where another surface lies before the point, or
  /// so close beside it in the picture that the pixels may mix. An owner in whose picture no other view agreed,
  /// `matched` false, owns a point that it borrowed: it shows a highlight there, or the edge of what stands in front.
  /// It is asked only where no other view sees the point, like one from which the point is hidden.
  Looks Collect(int owner, bool matched, const SurfaceElement& element) const;

 private:
  bool IsHidden(int view, const SurfaceElement& element) const;
  void Add(int view, const SurfaceElement& element, double share, Looks* looks) const;
  /// Those of the owner's neighbours whose score is at least `least` times `best` and less than `below` times it.
  void AddNeighbours(int owner, const SurfaceElement& element, double best, double least, double below,
                     Looks* looks) const;

  const LevelContext& context_;
  const std::vector<PatchMap>& maps_;
  std::vector<std::vector<float>> nearest_;  ///< by view and cell: the largest 1/z in the cells about it, 0 if empty
};

}  // namespace drupe::dense
