#include "reconstruction/dense/level_context.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <numbers>

namespace drupe::dense {

namespace {

constexpr double kLeastFacing = 0.26;           ///< cosine of 75 degrees
constexpr double kLeastReferenceFacing = 0.17;  ///< cosine of 80 degrees

/// The largest angle between the rays of the reference and of the agreeing views, as its cosine.
double WidestCosine(const DenseScene& scene, int reference, const Eigen::Vector3d& position, std::uint32_t agreeing) {
  const Eigen::Vector3d from = (scene.views[reference].centre - position).normalized();
  double least = 1;
  for (std::uint32_t rest = agreeing; rest != 0; rest &= rest - 1) {
    const int neighbour = scene.neighbours[reference][std::countr_zero(rest)];
    least = std::min(least, from.dot((scene.views[neighbour].centre - position).normalized()));
  }
  return least;
}

}  // namespace

PatchMap LevelContext::EmptyMap(int view) const {
  const SampledImage& image = frames[view].reference;
  return PatchMap(level, csize, image.width, image.height, frames[view].unit);
}

LevelContext MakeLevelContext(const DenseScene& scene, int level, int csize) {
  LevelContext context;
  context.scene = &scene;
  context.level = level;
  context.csize = csize;
  context.settings.half = scene.options->wsize / 2;
  for (std::size_t i = 0; i < scene.views.size(); ++i) {
    context.cameras.push_back(scene.views[i].CameraAt(level));
    context.frames.push_back(
        MakeRefinerFrame(scene.views, static_cast<int>(i), scene.neighbours[i], level, scene.typical_depth));
  }
  return context;
}

std::uint32_t FacingNeighbours(const DenseScene& scene, int reference, const SurfaceElement& element) {
  const auto facing = [&](int view) {
    return element.normal.dot((scene.views[view].centre - element.position).normalized());
  };
  if (facing(reference) < kLeastReferenceFacing) return 0;
  std::uint32_t bits = 0;
  const std::vector<int>& neighbours = scene.neighbours[reference];
  for (std::size_t k = 0; k < neighbours.size(); ++k) {
    if (facing(neighbours[k]) >= kLeastFacing) bits |= std::uint32_t{1} << k;
  }
  return bits;
}

bool IsBackground(const LevelContext& context, int reference, int u, int v) {
  constexpr std::uint32_t kBlack = 14 * 256;  // grey levels, as luma is stored
  const SampledImage& image = context.frames[reference].reference;
  if ((image.pairs[static_cast<std::ptrdiff_t>(v) * image.stride + u] & 0xFFFF) < kBlack) return true;
  const double scale = std::ldexp(1.0, context.level);
  return context.scene->silhouettes[reference].IsBackground((u + 0.5) * scale - 0.5, (v + 0.5) * scale - 0.5);
}

bool IsAcceptable(const LevelContext& context, int reference, double u, double v, const PatchCell& cell) {
  const DenseScene& scene = *context.scene;
  if (!(cell.w > 0) || cell.ncc < scene.options->threshold) return false;
  if (std::popcount(cell.views) + 1 < scene.options->min_image_num) return false;
  const SurfaceElement element = ToWorld(scene.views[reference], context.cameras[reference], u, v, cell);
  if (!element.position.allFinite() || !scene.region.Contains(element.position)) return false;
  const Eigen::Vector3d sight = (scene.views[reference].centre - element.position).normalized();
  if (element.normal.dot(sight) < kLeastReferenceFacing) return false;
  const double least_angle = scene.options->max_angle_deg * std::numbers::pi / 180;
  return WidestCosine(scene, reference, element.position, cell.views) <= std::cos(least_angle);
}

}  // namespace drupe::dense
