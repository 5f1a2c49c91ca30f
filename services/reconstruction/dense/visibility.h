#pragma once

#include <cstdint>
#include <optional>
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

/// The patch in a cell of the neighbour's map as the reference would see it, in the cell of the reference's map that it
/// falls into. Nothing where that cell is filled, or the patch faces away from the reference or from all others.
std::optional<PatchGuess> SeenFrom(const LevelContext& context, int reference, int neighbour,
                                   const std::vector<PatchMap>& maps, int cell);

/// Removes patches that other views contradict (PMVS's visibility consistency): kept are those that at least two
/// other views' patches agree with (one where hardly more can see the place), and a share of those that can see it; no
/// fewer views agree than are violated; they lie within the fruit's outlines.
Status FilterByVisibility(const LevelContext& context, const RunContext& run, std::vector<PatchMap>* maps);

/// Fills the empty cells of every map with the patches that its neighbours have there: where a view sees a highlight,
/// others do not. Borrowed patches have no agreeing views of their own (views = 0).
Status BorrowFromNeighbours(const LevelContext& context, const RunContext& run, std::vector<PatchMap>* maps);

/// By how much the reference is the view that sees an element best, in scale and angle, of those from which nothing
/// hides it: the angle in radians by which the normal would have to turn for another view to see it as well; negative
/// where another view sees it better. At most kClearLead. (A false element beyond a view's outline faces other views
/// better, where nothing confirms it: so it is nobody's.)
double OwnerLead(const LevelContext& context, int reference, const std::vector<PatchMap>& maps,
                 const SurfaceElement& element);
constexpr double kClearLead = 0.1;

/// Flags the cells of the reference's map whose lead is least_lead or more, and those up to `reach` cells around them.
std::vector<std::uint8_t> OwnedCells(const LevelContext& context, int reference, const std::vector<PatchMap>& maps,
                                     double least_lead, int reach);

/// How well a view measures an element: pixels per surface area, up to a factor; <= 0 from behind.
double ViewScore(const DenseScene& scene, int view, const SurfaceElement& element);

}  // namespace drupe::dense
