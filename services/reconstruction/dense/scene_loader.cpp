#include "reconstruction/dense/scene_loader.h"

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>

#include "base/parallel.h"
#include "reconstruction/dense/neighbour_views.h"
#include "reconstruction/dense/progress_span.h"

namespace drupe::dense {

namespace {

constexpr int kCoarsestSide = 240;     ///< pixels: the coarsest level is the first that is not larger
constexpr double kBytesPerPixel = 13;  ///< colour, luma pairs of all levels, patches

/// Registered views that see the region, with the rectangle that shows it; pictures are not loaded yet.
std::vector<std::pair<DenseView, PixelRect>> ViewsOfRegion(const SparseModel& model, const RegionOfInterest& region) {
  constexpr int kLeastSide = 48;
  std::vector<std::pair<DenseView, PixelRect>> views;
  for (std::size_t i = 0; i < model.views.size(); ++i) {
    if (!model.views[i].cam_from_world) continue;
    DenseView view;
    view.index = static_cast<int>(i);
    view.cam_from_world = *model.views[i].cam_from_world;
    view.centre = view.cam_from_world.Centre();
    const PixelRect rect = ProjectRegion(region, model.camera, view.cam_from_world);
    if (rect.Width() >= kLeastSide && rect.Height() >= kLeastSide) views.emplace_back(std::move(view), rect);
  }
  return views;
}

LevelPlan PlanLevels(const std::vector<std::pair<DenseView, PixelRect>>& views, const DenseOptions& options) {
  double pixels = 0;
  int side = 0;
  for (const auto& [view, rect] : views) {
    pixels += static_cast<double>(rect.Width()) * rect.Height();
    side = std::max({side, rect.Width(), rect.Height()});
  }
  LevelPlan plan;
  plan.finest = options.level;
  const auto bytes = [&] { return pixels * (3 + (kBytesPerPixel - 3) * std::pow(0.25, plan.finest)); };
  while (plan.finest < 6 && bytes() > static_cast<double>(options.memory_limit_mb) * 1e6) ++plan.finest;
  plan.coarsest = plan.finest + 1;  // one level above shows who sees what
  while ((side >> plan.coarsest) > kCoarsestSide) ++plan.coarsest;
  return plan;
}

double MedianDepth(const SparseModel& model, const RegionOfInterest& region, const std::vector<DenseView>& views) {
  std::vector<double> depths;
  for (const Track& track : model.tracks) {
    if (!region.Contains(track.position)) continue;
    for (const DenseView& view : views) depths.push_back((view.cam_from_world * track.position).z());
  }
  std::erase_if(depths, [](double depth) { return depth <= 0; });
  if (depths.empty()) return 1;
  const auto middle = depths.begin() + static_cast<std::ptrdiff_t>(depths.size() / 2);
  std::nth_element(depths.begin(), middle, depths.end());
  return *middle;
}

Status LoadPictures(const DenseInput& input, const std::vector<PixelRect>& rects, const LevelPlan& plan,
                    const RunContext& run, std::vector<DenseView>* views) {
  std::vector<Status> outcomes(views->size());
  ProgressSpan progress(run, 0, kLoadedShare, static_cast<double>(views->size()));
  DRUPE_RETURN_IF_ERROR(ParallelFor(run, views->size(), [&](std::size_t i) {
    Result<RgbImage> picture = input.load_rgb((*views)[i].index);
    if (!picture.ok()) {
      outcomes[i] = picture.status();
      return;
    }
    const PinholeCamera& camera = input.model->camera;
    if (picture->width() != camera.width || picture->height() != camera.height || picture->channels() != 3) {
      outcomes[i] = Unprocessable("image_size_mismatch", "picture " + input.model->views[(*views)[i].index].image +
                                                             " does not have the size of the camera");
      return;
    }
    BuildPyramid(*picture, camera, rects[i], plan.coarsest + 1, &(*views)[i]);
    DropLevelsBelow(plan.finest, &(*views)[i]);
    progress.Add(1);
  }));
  for (const Status& outcome : outcomes) DRUPE_RETURN_IF_ERROR(outcome);
  return Status::Ok();
}

}  // namespace

Result<DenseScene> LoadScene(const DenseInput& input, const DenseOptions& options, const RunContext& run,
                             LevelPlan* plan) {
  DenseScene scene;
  scene.options = &options;
  scene.model = input.model;
  DRUPE_ASSIGN_OR_RETURN(scene.region, FindRegionOfInterest(*input.model, options));
  auto found = ViewsOfRegion(*input.model, scene.region);
  if (static_cast<int>(found.size()) < options.min_image_num) {
    return Unprocessable("too_few_views", std::to_string(found.size()) + " registered pictures show the scene, " +
                                              std::to_string(options.min_image_num) + " are needed");
  }
  *plan = PlanLevels(found, options);
  std::vector<PixelRect> rects;
  for (auto& [view, rect] : found) {
    scene.views.push_back(std::move(view));
    rects.push_back(rect);
  }
  scene.typical_depth = MedianDepth(*input.model, scene.region, scene.views);
  scene.neighbours = SelectNeighbours(*input.model, scene.region, scene.views);
  DRUPE_RETURN_IF_ERROR(LoadPictures(input, rects, *plan, run, &scene.views));
  scene.silhouettes.resize(scene.views.size());
  if (options.scene == DenseOptions::Scene::kFruit) {
    scene.silhouettes = FindSilhouettes(*input.model, scene.region, scene.views);
  }
  return scene;
}

}  // namespace drupe::dense
