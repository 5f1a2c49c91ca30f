#pragma once

#include <cstdint>
#include <vector>

#include "reconstruction/dense/level_context.h"

namespace drupe::dense {

/// How one view's patches see a surface element.
enum class Sight {
  kUnknown,   ///< no patch there
  kAgrees,    ///< a patch lies at the same depth
  kOccluded,  ///< a patch lies in front
  kViolated,  ///< a patch lies behind: the element would hide it
};

/// Compares an element with the patches of `view` at the element's projection; `tolerance` in pixels of parallax.
Sight LookAt(const LevelContext& context, int view, const PatchMap& map, const SurfaceElement& element,
             float tolerance);

/// Removes patches that other views contradict (PMVS's visibility consistency): kept are those that at least two
/// other views' patches agree with, and no fewer views agree than are violated.
Status FilterByVisibility(const LevelContext& context, const RunContext& run, std::vector<PatchMap>* maps);

/// Fills the empty cells of every map with the patches that its neighbours have there: where a view sees a highlight,
/// others do not. Borrowed patches have no agreeing views of their own (views = 0).
Status BorrowFromNeighbours(const LevelContext& context, const RunContext& run, std::vector<PatchMap>* maps);

/// True when no neighbour from which the element is not hidden sees it at a better scale and angle. With slack below 1
/// also when the reference comes within this factor of the best. (A false element beyond a view's outline faces other
/// views better, where nothing confirms it: so it is nobody's.)
bool OwnsElement(const LevelContext& context, int reference, const std::vector<PatchMap>& maps,
                 const SurfaceElement& element, double slack);

/// OwnsElement for every cell of the reference's map.
std::vector<std::uint8_t> OwnedCells(const LevelContext& context, int reference, const std::vector<PatchMap>& maps,
                                     double slack);

/// How well a view measures an element: pixels per surface area, up to a factor; <= 0 from behind.
double ViewScore(const DenseScene& scene, int view, const SurfaceElement& element);

}  // namespace drupe::dense
