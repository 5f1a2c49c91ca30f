#include "reconstruction/dense/point_colours.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "base/parallel.h"
#include "reconstruction/dense/progress_span.h"
#include "reconstruction/dense/shading.h"

namespace drupe::dense {

namespace {

constexpr std::size_t kChunk = 8192;            ///< points a work item
constexpr std::size_t kShadingPoints = 20'000;  ///< points that the shading is fitted to
constexpr double kLeastShare = 0.75;            ///< a view's score against the best: beyond it the skin is seen aslant
constexpr double kLeastShareElsewhere = 0.4;    ///< the same where the owner's own look cannot be trusted
constexpr float kBrighter = 0.06f, kDarker = 0.12f;  ///< logarithmic green, from the median
constexpr float kSightTolerance = 2.0f;              ///< pixels of parallax, for visibility
constexpr float kSaturated = 252.0f;
constexpr int kMaxLooks = 1 + 16;

/// What one view shows of a point.
struct Look {
  Eigen::Array3f log_colour;
  Eigen::Vector3f normal_in_cam;
  float weight = 0;
};

struct Looks {
  std::array<Look, kMaxLooks> items;
  int count = 0;
};

/// Bilinear; false outside the picture.
bool SampleRgb(const DenseView& view, const Eigen::Vector2d& pixel, Eigen::Array3f* rgb) {
  const RgbImage& image = view.rgb;
  if (!(pixel.x() >= 0 && pixel.y() >= 0 && pixel.x() < image.width() - 1 && pixel.y() < image.height() - 1)) {
    return false;
  }
  const int x = static_cast<int>(pixel.x()), y = static_cast<int>(pixel.y());
  const auto fx = static_cast<float>(pixel.x() - x), fy = static_cast<float>(pixel.y() - y);
  const std::uint8_t *top = image.Row(y) + 3 * x, *bottom = image.Row(y + 1) + 3 * x;
  for (int c = 0; c < 3; ++c) {
    const float upper = static_cast<float>(top[c]) + fx * static_cast<float>(top[c + 3] - top[c]);
    const float lower = static_cast<float>(bottom[c]) + fx * static_cast<float>(bottom[c + 3] - bottom[c]);
    (*rgb)[c] = upper + fy * (lower - upper);
  }
  return true;
}

void AddLook(const LevelContext& context, const std::vector<PatchMap>& maps, int view, const SurfaceElement& element,
             double share, bool check_sight, Looks* looks) {
  const DenseView& camera_view = context.scene->views[view];
  const Eigen::Vector3d in_cam = camera_view.cam_from_world * element.position;
  Eigen::Array3f rgb;
  if (in_cam.z() <= 0 || !SampleRgb(camera_view, camera_view.camera.Pixel(in_cam), &rgb)) return;
  if (rgb.maxCoeff() > kSaturated) return;
  if (check_sight && LookAt(context, view, maps[view], element, kSightTolerance) == Sight::kOccluded) return;
  Look& look = looks->items[looks->count++];
  look.log_colour = (rgb + 1.0f).log();
  look.normal_in_cam = (camera_view.cam_from_world.rotation * element.normal).cast<float>();
  const auto share4 = static_cast<float>(share * share * share * share);
  look.weight = share4 * share4;
}

/// The owner first, then its neighbours in their order. An owner in whose picture no other view agreed, `matched`
/// false, owns a point that it borrowed: it shows a highlight there, or the edge of what stands in front. It has no say
/// as long as any other view sees the point.
Looks CollectLooks(const LevelContext& context, const std::vector<PatchMap>& maps, int owner, bool matched,
                   const SurfaceElement& element) {
  Looks looks;
  const double best = ViewScore(*context.scene, owner, element);
  const double least_share = matched ? kLeastShare : kLeastShareElsewhere;
  if (matched) AddLook(context, maps, owner, element, 1.0, false, &looks);
  for (const int neighbour : context.scene->neighbours[owner]) {
    const double share = ViewScore(*context.scene, neighbour, element) / best;
    if (share >= least_share && looks.count < kMaxLooks) {
      AddLook(context, maps, neighbour, element, std::min(share, 1.0), true, &looks);
    }
  }
  if (looks.count == 0) AddLook(context, maps, owner, element, 1.0, false, &looks);
  return looks;
}

float WeightedMedianGreen(const Looks& looks, const std::array<Eigen::Array3f, kMaxLooks>& values) {
  std::array<std::pair<float, float>, kMaxLooks> sorted;
  float total = 0;
  for (int i = 0; i < looks.count; ++i) {
    sorted[i] = {values[i][1], looks.items[i].weight};
    total += looks.items[i].weight;
  }
  std::sort(sorted.begin(), sorted.begin() + looks.count);
  float below = 0;
  for (int i = 0; i < looks.count; ++i) {
    below += sorted[i].second;
    if (below >= 0.5f * total) return sorted[i].first;
  }
  return sorted[looks.count - 1].first;
}

using Rgb = Eigen::Matrix<std::uint8_t, 3, 1>;

/// The two colours of a point, sRGB.
struct PointColours {
  Rgb skin = Rgb::Constant(255);
  Rgb pictured = Rgb::Constant(255);
};

Rgb FromLog(const Eigen::Array3f& log_colour) {
  const Eigen::Array3f rgb = log_colour.exp() - 1.0f;
  return (rgb.max(0.0f).min(255.0f) + 0.5f).cast<std::uint8_t>().matrix();
}

/// The robust means of the looks with the shading taken out and left in, over the same looks: those that agree once the
/// shading is gone.
PointColours RobustColours(const Looks& looks, const ShadingModel& shading) {
  std::array<Eigen::Array3f, kMaxLooks> values;
  for (int i = 0; i < looks.count; ++i) {
    values[i] = looks.items[i].log_colour - shading.Log(looks.items[i].normal_in_cam);
  }
  const float median = WeightedMedianGreen(looks, values);
  Eigen::Array3f sum = Eigen::Array3f::Zero(), raw_sum = Eigen::Array3f::Zero();
  float weights = 0;
  for (int i = 0; i < looks.count; ++i) {
    const float above = values[i][1] - median;
    if (above > kBrighter || above < -kDarker) continue;
    sum += looks.items[i].weight * values[i];
    raw_sum += looks.items[i].weight * looks.items[i].log_colour;
    weights += looks.items[i].weight;
  }
  return {FromLog(sum / weights), FromLog(raw_sum / weights)};
}

SurfaceElement ElementAt(const PointCloud& cloud, std::size_t i) {
  return {cloud.positions[i].cast<double>(), cloud.normals[i].cast<double>()};
}

/// The board has one normal and colours of its own, which would pass for the shading of that normal: only what stands
/// above it counts. World: the board's frame.
ShadingModel FitShading(const LevelContext& context, const std::vector<PatchMap>& maps, const std::vector<int>& owners,
                        const PointCloud& cloud) {
  const double min_height = context.scene->options->min_height_mm;
  std::vector<ShadingSample> samples;
  const std::size_t step = std::max<std::size_t>(1, cloud.size() / kShadingPoints);
  for (std::size_t i = 0; i < cloud.size(); i += step) {
    if (cloud.positions[i].z() < min_height) continue;
    const Looks looks = CollectLooks(context, maps, owners[i], cloud.view_counts[i] > 1, ElementAt(cloud, i));
    for (int k = 0; k < looks.count; ++k) samples.push_back({looks.items[k].normal_in_cam, looks.items[k].log_colour});
  }
  return ShadingModel::Fit(samples);
}

}  // namespace

Status ColourPoints(const LevelContext& context, const std::vector<PatchMap>& maps, const std::vector<int>& owners,
                    bool remove_shading, const RunContext& run, PointCloud* cloud) {
  const ShadingModel shading = remove_shading ? FitShading(context, maps, owners, *cloud) : ShadingModel();
  cloud->colours.resize(cloud->size());
  cloud->raw_colours.resize(cloud->size());
  ProgressSpan progress(run, kAssembledShare, 1, static_cast<double>(cloud->size()));
  return ParallelFor(run, (cloud->size() + kChunk - 1) / kChunk, [&](std::size_t chunk) {
    const std::size_t end = std::min(cloud->size(), (chunk + 1) * kChunk);
    for (std::size_t i = chunk * kChunk; i < end; ++i) {
      const Looks looks = CollectLooks(context, maps, owners[i], cloud->view_counts[i] > 1, ElementAt(*cloud, i));
      const PointColours colours = looks.count > 0 ? RobustColours(looks, shading) : PointColours();
      cloud->colours[i] = colours.skin;
      cloud->raw_colours[i] = colours.pictured;
    }
    progress.Add(kChunk);
  });
}

}  // namespace drupe::dense
