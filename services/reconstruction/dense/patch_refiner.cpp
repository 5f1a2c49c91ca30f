#include "reconstruction/dense/patch_refiner.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "reconstruction/dense/patch_refiner.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "reconstruction/dense/patch_refiner_lanes-inl.h"

#if HWY_ONCE
namespace drupe::dense {

HWY_EXPORT(RefineBatch);

void RefinePatches(const RefinerFrame& frame, const RefinerSettings& settings, PatchBatch* batch) {
  // Unused lanes repeat the first patch, so that they read valid pixels.
  for (int lane = batch->count; lane < PatchBatch::kSize; ++lane) {
    batch->u[lane] = batch->u[0];
    batch->v[lane] = batch->v[0];
    batch->w[lane] = batch->w[0];
    batch->wu[lane] = batch->wu[0];
    batch->wv[lane] = batch->wv[0];
    batch->depth_sigma[lane] = batch->depth_sigma[0];
    batch->views[lane] = batch->views[0];
  }
  HWY_DYNAMIC_DISPATCH(RefineBatch)(frame, settings, batch);
}

RefinerFrame MakeRefinerFrame(const std::vector<DenseView>& views, int reference, const std::vector<int>& neighbours,
                              int level, double typical_depth) {
  const auto sampled = [level](const DenseView& view) {
    const LumaPairs& pairs = view.luma[level];
    return SampledImage{pairs.Row(0), static_cast<std::int32_t>(pairs.stride()), pairs.width(), pairs.height()};
  };
  const DenseView& ref = views[reference];
  const LevelCamera from = ref.CameraAt(level);
  Eigen::Matrix3d k_inverse;
  k_inverse << 1 / from.fx, 0, -from.cx / from.fx, 0, 1 / from.fy, -from.cy / from.fy, 0, 0, 1;
  RefinerFrame frame;
  frame.reference = sampled(ref);
  double parallax = 0;  // pixels for a unit of inverse depth
  for (const int neighbour : neighbours) {
    const DenseView& view = views[neighbour];
    const LevelCamera to = view.CameraAt(level);
    Eigen::Matrix3d k;
    k << to.fx, 0, to.cx, 0, to.fy, to.cy, 0, 0, 1;
    const Rigid3 relative = view.cam_from_world * ref.cam_from_world.Inverse();
    const Eigen::Matrix3d a = k * relative.rotation * k_inverse;
    const Eigen::Vector3d b = k * relative.translation;
    NeighbourWarp warp{sampled(view), {}, {}};
    for (int i = 0; i < 9; ++i) warp.a[i] = static_cast<float>(a(i / 3, i % 3));
    for (int i = 0; i < 3; ++i) warp.b[i] = static_cast<float>(b[i]);
    frame.neighbours.push_back(warp);
    parallax += to.fx * (view.centre - ref.centre).norm() / static_cast<double>(neighbours.size());
  }
  // A neighbour aims at the same place, so its own rotation makes up for a part of the shift, never for the parallax.
  frame.unit = static_cast<float>(parallax > 0 ? 1.0 / parallax : 1.0 / typical_depth);
  return frame;
}

}  // namespace drupe::dense
#endif  // HWY_ONCE
