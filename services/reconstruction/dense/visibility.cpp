#include "reconstruction/dense/visibility.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <optional>
#include <utility>

#include "base/parallel.h"

namespace drupe::dense {

namespace {

constexpr float kTolerance = 1.0f;  ///< pixels of parallax
/// Of the distance: so far in front, another surface hides an element; nearer, one of the two is wrong.
constexpr double kHidden = 0.02;
constexpr int kLeastAgreeing = 2;
constexpr double kLeastAgreeingShare = 0.4;  ///< of the witnesses
constexpr int kFewWitnesses = 4;             ///< where so few see the surface, one that agrees will do

SurfaceElement ElementOf(const LevelContext& context, int view, const PatchMap& map, int col, int row) {
  return ToWorld(context.scene->views[view], context.cameras[view], map.Pixel(col), map.Pixel(row), map.At(col, row));
}

/// kHidden in pixels of parallax.
float HidingTolerance(const LevelContext& context, int view, const PatchMap& map, const SurfaceElement& element) {
  const double distance = (context.scene->views[view].centre - element.position).norm();
  return static_cast<float>(kHidden / (distance * map.unit));
}

/// What the neighbours of a patch's reference say of it.
struct Testimony {
  int agree = 0;
  int violated = 0;
  int witnesses = 0;  ///< face the element, and nothing hides it from them
};

Testimony AskNeighbours(const LevelContext& context, int reference, const std::vector<PatchMap>& maps,
                        const SurfaceElement& element) {
  Testimony testimony;
  const std::vector<int>& neighbours = context.scene->neighbours[reference];
  const std::uint32_t facing = FacingNeighbours(*context.scene, reference, element);
  for (std::size_t k = 0; k < neighbours.size(); ++k) {
    const PatchMap& map = maps[neighbours[k]];
    const Sight sight = LookAt(context, neighbours[k], map, element, kTolerance);
    testimony.agree += sight == Sight::kAgrees ? 1 : 0;
    testimony.violated += sight == Sight::kViolated ? 1 : 0;
    if ((facing >> k & 1) == 0) continue;
    const bool hidden =
        sight == Sight::kOccluded && LookAt(context, neighbours[k], map, element,
                                            HidingTolerance(context, neighbours[k], map, element)) == Sight::kOccluded;
    testimony.witnesses += hidden ? 0 : 1;
  }
  return testimony;
}

/// `photo_consistent`: the reference's own pixels agree with min_image_num - 1 views.
bool IsConfirmed(const LevelContext& context, int reference, const std::vector<PatchMap>& maps,
                 const SurfaceElement& element, bool photo_consistent) {
  const Testimony testimony = AskNeighbours(context, reference, maps, element);
  const bool hardly_seen = photo_consistent && testimony.witnesses <= kFewWitnesses && testimony.violated == 0;
  if (testimony.agree < (hardly_seen ? 1 : kLeastAgreeing) || testimony.agree < testimony.violated) return false;
  if (testimony.agree < kLeastAgreeingShare * testimony.witnesses) return false;
  return !IsOutsideHull(context.scene->views, context.scene->silhouettes, element.position);
}

/// Puts the patches of `neighbour` into the cells that are empty in the reference's own map, the nearer surface first,
/// of one surface the patch with the better NCC.
void BorrowFrom(const LevelContext& context, int reference, int neighbour, const std::vector<PatchMap>& maps,
                PatchMap* filled) {
  constexpr float kSameSight = 2.0f;  // pixels of parallax
  const PatchMap& own = maps[reference];
  for (std::size_t i = 0; i < maps[neighbour].cells.size(); ++i) {
    if (!maps[neighbour].cells[i].Filled()) continue;
    const std::optional<PatchGuess> seen = SeenFrom(context, reference, neighbour, maps, static_cast<int>(i));
    if (!seen) continue;
    PatchCell& cell = filled->cells[seen->cell];
    const float nearer = (seen->plane.w - cell.w) / own.unit;
    const bool better = nearer > -kSameSight && seen->plane.ncc > cell.ncc;
    if (!cell.Filled() || nearer > kSameSight || better) cell = seen->plane;
  }
}

/// Removes the borrowed patches that the views' own patches do not confirm.
void DropUnconfirmed(const LevelContext& context, int reference, const std::vector<PatchMap>& maps, PatchMap* filled) {
  for (std::size_t i = 0; i < filled->cells.size(); ++i) {
    if (!filled->cells[i].Filled() || maps[reference].cells[i].Filled()) continue;
    const SurfaceElement element =
        ElementOf(context, reference, *filled, static_cast<int>(i) % filled->cols, static_cast<int>(i) / filled->cols);
    if (!IsConfirmed(context, reference, maps, element, false)) filled->cells[i] = PatchCell();
  }
}

}  // namespace

std::optional<PatchGuess> SeenFrom(const LevelContext& context, int reference, int neighbour,
                                   const std::vector<PatchMap>& maps, int cell) {
  const PatchMap &own = maps[reference], &other = maps[neighbour];
  const DenseView& view = context.scene->views[reference];
  const LevelCamera& camera = context.cameras[reference];
  const SurfaceElement element = ElementOf(context, neighbour, other, cell % other.cols, cell / other.cols);
  if (FacingNeighbours(*context.scene, reference, element) == 0) return std::nullopt;
  PatchCell patch = FromWorld(view, camera, element);
  const Eigen::Vector2d pixel = camera.Pixel(view.cam_from_world * element.position);
  const int col = own.CellOf(pixel.x()), row = own.CellOf(pixel.y());
  if (patch.w <= 0 || !own.Holds(col, row) || own.At(col, row).Filled()) return std::nullopt;
  patch.w += static_cast<float>((own.Pixel(col) - pixel.x()) * patch.wu + (own.Pixel(row) - pixel.y()) * patch.wv);
  patch.ncc = other.cells[cell].ncc;
  patch.sigma = other.cells[cell].sigma;
  return PatchGuess{row * own.cols + col, patch};
}

Sight LookAt(const LevelContext& context, int view, const PatchMap& map, const SurfaceElement& element,
             float tolerance) {
  const DenseView& camera_view = context.scene->views[view];
  const Eigen::Vector3d in_cam = camera_view.cam_from_world * element.position;
  if (in_cam.z() <= 0) return Sight::kUnknown;
  const Eigen::Vector2d pixel = context.cameras[view].Pixel(in_cam);
  const int col = map.CellOf(pixel.x()), row = map.CellOf(pixel.y());
  if (!map.Holds(col, row) || !map.At(col, row).Filled()) return Sight::kUnknown;
  const PatchCell& cell = map.At(col, row);
  const double plane = cell.w + cell.wu * (pixel.x() - map.Pixel(col)) + cell.wv * (pixel.y() - map.Pixel(row));
  const double nearer = (1 / in_cam.z() - plane) / map.unit;
  if (std::abs(nearer) <= tolerance) return Sight::kAgrees;
  return nearer < 0 ? Sight::kOccluded : Sight::kViolated;
}

double ViewScore(const DenseScene& scene, int view, const SurfaceElement& element) {
  const Eigen::Vector3d towards = scene.views[view].centre - element.position;
  const double distance = towards.norm();
  return element.normal.dot(towards) * scene.typical_depth * scene.typical_depth / (distance * distance * distance);
}

Status BorrowFromNeighbours(const LevelContext& context, const RunContext& run, std::vector<PatchMap>* maps) {
  std::vector<PatchMap> filled = *maps;
  DRUPE_RETURN_IF_ERROR(ParallelFor(run, maps->size(), [&](std::size_t view) {
    for (const int neighbour : context.scene->neighbours[view]) {
      BorrowFrom(context, static_cast<int>(view), neighbour, *maps, &filled[view]);
    }
    DropUnconfirmed(context, static_cast<int>(view), *maps, &filled[view]);
  }));
  *maps = std::move(filled);
  return Status::Ok();
}

Status FilterByVisibility(const LevelContext& context, const RunContext& run, std::vector<PatchMap>* maps) {
  std::vector<std::vector<std::uint8_t>> keep(maps->size());
  DRUPE_RETURN_IF_ERROR(ParallelFor(run, maps->size(), [&](std::size_t view) {
    const PatchMap& map = (*maps)[view];
    keep[view].assign(map.cells.size(), 0);
    for (std::size_t i = 0; i < map.cells.size(); ++i) {
      if (!map.cells[i].Filled()) continue;
      const SurfaceElement element = ElementOf(context, static_cast<int>(view), map, static_cast<int>(i) % map.cols,
                                               static_cast<int>(i) / map.cols);
      keep[view][i] = IsConfirmed(context, static_cast<int>(view), *maps, element, map.cells[i].views != 0) ? 1 : 0;
    }
  }));
  for (std::size_t view = 0; view < maps->size(); ++view) {
    for (std::size_t i = 0; i < keep[view].size(); ++i) {
      if (!keep[view][i]) (*maps)[view].cells[i] = PatchCell();
    }
  }
  return Status::Ok();
}

double OwnerLead(const LevelContext& context, int reference, const std::vector<PatchMap>& maps,
                 const SurfaceElement& element) {
  constexpr double kLeastApart = 0.02;  // radians between two views
  const DenseScene& scene = *context.scene;
  const double own = ViewScore(scene, reference, element);
  if (own <= 0) return -kClearLead;
  const auto direction = [&](int view) { return (scene.views[view].centre - element.position).normalized(); };
  const Eigen::Vector3d own_direction = direction(reference);
  double lead = kClearLead;
  for (const int neighbour : scene.neighbours[reference]) {
    const double other = ViewScore(scene, neighbour, element);
    if (other <= 0) continue;
    const double over = (own / other - 1) / std::max((own_direction - direction(neighbour)).norm(), kLeastApart);
    if (over >= lead) continue;
    const float tolerance = HidingTolerance(context, neighbour, maps[neighbour], element);
    if (LookAt(context, neighbour, maps[neighbour], element, tolerance) != Sight::kOccluded) lead = over;
  }
  return lead;
}

std::vector<std::uint8_t> OwnedCells(const LevelContext& context, int reference, const std::vector<PatchMap>& maps,
                                     double least_lead, int reach) {
  const PatchMap& map = maps[reference];
  std::vector<std::uint8_t> owned(map.cells.size(), 0);
  for (int row = 0; row < map.rows; ++row) {
    for (int col = 0; col < map.cols; ++col) {
      if (!map.At(col, row).Filled()) continue;
      const SurfaceElement element = ElementOf(context, reference, map, col, row);
      if (OwnerLead(context, reference, maps, element) < least_lead) continue;
      for (int r = std::max(row - reach, 0); r <= std::min(row + reach, map.rows - 1); ++r) {
        for (int c = std::max(col - reach, 0); c <= std::min(col + reach, map.cols - 1); ++c) {
          owned[static_cast<std::size_t>(r) * map.cols + c] = 1;
        }
      }
    }
  }
  return owned;
}

}  // namespace drupe::dense
