#include "defect_analysis/fruit/extract_fruits.h"

#include <algorithm>
#include <cmath>

#include "base/log.h"
#include "base/parallel.h"
#include "defect_analysis/fruit/closed_surface.h"
#include "defect_analysis/fruit/foreign_colours.h"
#include "defect_analysis/fruit/ground.h"
#include "defect_analysis/fruit/objects.h"
#include "geometry/robust.h"

namespace drupe {
namespace {

constexpr double kVoxelShare = 0.006;     // of the cloud's diagonal, where the scale is unknown
constexpr double kClearanceShare = 0.02;  // the same for the height above the ground
constexpr std::size_t kNoiseSample = 20000;

struct Layout {
  CloudBox box;
  std::optional<Ground> ground;
  double clearance = 0;
  double voxel = 0;
};

Layout LayOut(const PointCloud& cloud, const FruitScene& scene, const FruitOptions& options, std::uint64_t seed) {
  Layout layout;
  layout.box = RobustBox(cloud);
  if (scene.metric) {
    layout.ground = Ground{};
    layout.clearance = options.board_clearance_mm;
    layout.voxel = options.voxel_mm;
  } else {
    const double size = layout.box.Diagonal();
    layout.ground = FindGround(cloud, size, scene.camera_centres, seed);
    layout.clearance = kClearanceShare * size;
    layout.voxel = kVoxelShare * size;
  }
  return layout;
}

std::vector<Eigen::Vector3d> PointsInMm(const PointCloud& cloud, const std::vector<std::uint32_t>& object,
                                        double mm_per_unit) {
  std::vector<Eigen::Vector3d> points;
  points.reserve(object.size());
  for (const std::uint32_t i : object) points.push_back(mm_per_unit * cloud.positions[i].cast<double>());
  return points;
}

Status CheckShape(const ClosedSurface& closed, const FruitOptions& options) {
  const double diameter = 2 * closed.surface.MeanRadius();
  if (diameter < options.min_diameter_mm || diameter > options.max_diameter_mm) {
    return Unprocessable("not_a_fruit", "its size is not a fruit's");
  }
  if (closed.residual_mm > options.max_shape_residual * diameter / 2) {
    return Unprocessable("not_a_fruit", "no smooth closed surface fits it");
  }
  if (closed.observed_share < options.min_observed_share) {
    return Unprocessable("not_a_fruit", "too little of its surface is seen");
  }
  return Status::Ok();
}

double NoiseOf(const std::vector<Eigen::Vector3d>& points, const FruitSurface& surface) {
  const std::size_t step = std::max<std::size_t>(1, points.size() / kNoiseSample);
  std::vector<float> residuals;
  for (std::size_t i = 0; i < points.size(); i += step) {
    const Eigen::Vector3f offset = (points[i] - surface.centre()).cast<float>();
    residuals.push_back(offset.norm() - surface.RadiusAt(offset));
  }
  return RobustSigma(std::move(residuals));
}

// Keeps the points on the skin.
void TakeSkin(const PointCloud& cloud, const std::vector<std::uint32_t>& object,
              const std::vector<Eigen::Vector3d>& points, double limit, FruitCloud& fruit) {
  for (std::size_t i = 0; i < points.size(); ++i) {
    const Eigen::Vector3f offset = (points[i] - fruit.surface.centre()).cast<float>();
    if (std::abs(offset.norm() - fruit.surface.RadiusAt(offset)) > limit) continue;
    const Rgb8& colour = cloud.colours[object[i]];
    fruit.offsets.push_back(offset);
    fruit.colours.push_back(colour);
    fruit.lab.push_back(LabFromSrgb(colour));
  }
}

Result<FruitCloud> MakeFruit(const PointCloud& cloud, const std::vector<std::uint32_t>& object, const Layout& layout,
                             bool metric, const FruitOptions& options) {
  FruitCloud fruit;
  if (layout.ground) fruit.up = layout.ground->normal;
  if (!metric) {
    DRUPE_ASSIGN_OR_RETURN(const Sphere sphere, FitSphere(PointsInMm(cloud, object, 1)));
    fruit.mm_per_unit = options.nominal_diameter_mm / (2 * sphere.radius);
  }
  const std::vector<Eigen::Vector3d> points = PointsInMm(cloud, object, fruit.mm_per_unit);
  DRUPE_ASSIGN_OR_RETURN(ClosedSurface closed, FitClosedSurface(points, fruit.up, options));
  DRUPE_RETURN_IF_ERROR(CheckShape(closed, options));
  fruit.surface = std::move(closed.surface);
  fruit.observed_share = closed.observed_share;
  fruit.noise_mm = NoiseOf(points, fruit.surface);
  TakeSkin(cloud, object, points, std::max(options.outlier_distance_mm, 3 * fruit.noise_mm), fruit);
  return fruit;
}

Result<std::vector<FruitCloud>> ExtractByGeometry(const PointCloud& cloud, const FruitScene& scene,
                                                  const FruitOptions& options, const RunContext& context) {
  const Layout layout = LayOut(cloud, scene, options, context.seed);
  auto objects = FindObjects(cloud, layout.box, layout.ground, layout.clearance, layout.voxel, options.min_points);
  DRUPE_RETURN_IF_ERROR(context.CheckCancelled());
  if (objects.size() > 2 * static_cast<std::size_t>(options.max_fruits)) objects.resize(2 * options.max_fruits);
  std::vector<std::optional<FruitCloud>> found(objects.size());
  DRUPE_RETURN_IF_ERROR(ParallelFor(context, objects.size(), [&](std::size_t i) {
    Result<FruitCloud> fruit = MakeFruit(cloud, objects[i], layout, scene.metric, options);
    if (fruit.ok()) {
      found[i] = std::move(fruit).value();
    } else {
      Log(LogLevel::kInfo, "object is no fruit", {{"points", objects[i].size()}, {"why", fruit.status().message()}});
    }
  }));
  DRUPE_RETURN_IF_ERROR(context.CheckCancelled());
  std::vector<FruitCloud> fruits;
  for (auto& fruit : found) {
    if (fruit && static_cast<int>(fruits.size()) < options.max_fruits) fruits.push_back(std::move(*fruit));
  }
  return fruits;
}

void JudgeColours(const ColourClassifier& classifier, const BackgroundOptions& options, FruitCloud& fruit) {
  const ForeignColours foreign = RemoveForeignColours(classifier, options, fruit);
  if (!foreign.known) {
    Log(LogLevel::kInfo, "the background model does not know this fruit", {{"known_share", foreign.known_share}});
  }
}

}  // namespace

Result<std::vector<FruitCloud>> ExtractFruits(const PointCloud& cloud, const FruitScene& scene,
                                              const FruitOptions& options, const BackgroundOptions& background,
                                              const RunContext& context) {
  DRUPE_ASSIGN_OR_RETURN(std::vector<FruitCloud> fruits, ExtractByGeometry(cloud, scene, options, context));
  if (scene.background_model == nullptr) return fruits;
  const ColourClassifier classifier(*scene.background_model);
  if (fruits.empty()) {
    const PointCloud coloured = KeepFruitColours(classifier, cloud);
    if (coloured.empty()) return fruits;
    DRUPE_ASSIGN_OR_RETURN(fruits, ExtractByGeometry(coloured, scene, options, context));
  }
  DRUPE_RETURN_IF_ERROR(
      ParallelFor(context, fruits.size(), [&](std::size_t i) { JudgeColours(classifier, background, fruits[i]); }));
  DRUPE_RETURN_IF_ERROR(context.CheckCancelled());
  return fruits;
}

}  // namespace drupe
