#include "reconstruction/dense/point_colours.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <utility>

#include "base/parallel.h"
#include "reconstruction/dense/looks.h"
#include "reconstruction/dense/progress_span.h"
#include "reconstruction/dense/shading.h"
#include "reconstruction/dense/smooth_normals.h"
#include "reconstruction/dense/surface_grid.h"
#include "reconstruction/dense/view_light.h"

namespace drupe::dense {

namespace {

constexpr std::size_t kChunk = 8192;                 ///< points a work item
constexpr std::size_t kShadingPoints = 20'000;       ///< points that the shading is fitted to
constexpr std::size_t kLightPoints = 150'000;        ///< points that the light of each view is fitted to
constexpr float kGridEdge = 1.5f;                    ///< world units, mm: so far the light changes little
constexpr float kBrighter = 0.06f, kDarker = 0.12f;  ///< logarithmic green, from the median

using Rgb = Eigen::Matrix<std::uint8_t, 3, 1>;
using LookColours = std::array<Eigen::Array3f, kMaxLooks>;

/// The two colours of a point, sRGB.
struct PointColours {
  Rgb skin = Rgb::Constant(255);
  Rgb pictured = Rgb::Constant(255);
};

/// The cloud to be coloured and what hides what in it.
struct Canvas {
  const DenseScene& scene;
  const LookCollector collector;
  const std::vector<int>& owners;
  const PointCloud& cloud;

  Looks LooksAt(std::size_t i) const {
    const SurfaceElement element{cloud.positions[i].cast<double>(), cloud.normals[i].cast<double>()};
    return collector.Collect(owners[i], cloud.view_counts[i] > 1, element);
  }

  /// The board has one normal and colours of its own, which would pass for the shading of that normal: only what stands
  /// above it tells of the light. World: the board's frame.
  bool IsAboveBoard(std::size_t i) const { return cloud.positions[i].z() >= scene.options->min_height_mm; }
};

/// The looks at about `count` of the points above the board, as pictured.
Result<std::vector<LightSample>> Sample(const Canvas& canvas, std::size_t count, const RunContext& run) {
  const std::size_t size = canvas.cloud.size(), step = std::max<std::size_t>(1, size / count);
  std::vector<std::vector<LightSample>> parts((size + kChunk - 1) / kChunk);
  DRUPE_RETURN_IF_ERROR(ParallelFor(run, parts.size(), [&](std::size_t part) {
    const std::size_t first = (part * kChunk + step - 1) / step * step, end = std::min(size, (part + 1) * kChunk);
    for (std::size_t i = first; i < end; i += step) {
      if (!canvas.IsAboveBoard(i)) continue;
      const Looks looks = canvas.LooksAt(i);
      for (int k = 0; k < looks.count; ++k) {
        const Look& look = looks.items[k];
        parts[part].push_back({static_cast<std::uint32_t>(i), look.view, look.share * look.share, look.log_colour});
      }
    }
  }));
  std::vector<LightSample> samples;
  for (const std::vector<LightSample>& part : parts) samples.insert(samples.end(), part.begin(), part.end());
  return samples;
}

/// What the lamps do: shading by the normal, and what each view's light adds to it.
struct Lamps {
  SurfaceGrid grid;
  SmoothNormals normals;
  ShadingModel shading;
  ViewLight light;

  explicit Lamps(const PointCloud& cloud)
      : grid(cloud.positions, kGridEdge), normals(grid, cloud.positions, cloud.normals) {}

  Eigen::Vector3f NormalInCam(const Canvas& canvas, const SurfaceGrid::Place& place, std::size_t i, int view) const {
    const Eigen::Vector3f normal = normals.At(place, canvas.cloud.positions[i], canvas.cloud.normals[i]);
    return canvas.scene.views[view].cam_from_world.rotation.cast<float>() * normal;
  }

  Status FitShading(const Canvas& canvas, const RunContext& run) {
    DRUPE_ASSIGN_OR_RETURN(const std::vector<LightSample> samples, Sample(canvas, kShadingPoints, run));
    std::vector<ShadingSample> by_normal;
    by_normal.reserve(samples.size());
    for (const LightSample& sample : samples) {
      const SurfaceGrid::Place place = grid.At(canvas.cloud.positions[sample.point]);
      by_normal.push_back({NormalInCam(canvas, place, sample.point, sample.view), sample.log_colour});
    }
    shading = ShadingModel::Fit(by_normal);
    return Status::Ok();
  }

  Status FitLight(const Canvas& canvas, const RunContext& run) {
    DRUPE_ASSIGN_OR_RETURN(std::vector<LightSample> samples, Sample(canvas, kLightPoints, run));
    for (LightSample& sample : samples) {
      const SurfaceGrid::Place place = grid.At(canvas.cloud.positions[sample.point]);
      sample.log_colour -= shading.Log(NormalInCam(canvas, place, sample.point, sample.view));
    }
    light = ViewLight::Fit(grid, canvas.cloud.positions, samples, static_cast<int>(canvas.scene.views.size()));
    return Status::Ok();
  }

  /// The looks at point i without what the lamps do to them.
  LookColours Unlit(const Canvas& canvas, std::size_t i, const Looks& looks) const {
    LookColours colours;
    const SurfaceGrid::Place place = grid.At(canvas.cloud.positions[i]);
    for (int k = 0; k < looks.count; ++k) {
      const Look& look = looks.items[k];
      colours[k] =
          look.log_colour - shading.Log(NormalInCam(canvas, place, i, look.view)) - light.Log(place, look.view);
    }
    return colours;
  }
};

LookColours AsPictured(const Looks& looks) {
  LookColours colours;
  for (int k = 0; k < looks.count; ++k) colours[k] = looks.items[k].log_colour;
  return colours;
}

/// The weighted median of the green channel; frontal looks count more, though none alone.
float MedianGreen(const Looks& looks, const LookColours& values) {
  std::array<std::pair<float, float>, kMaxLooks> sorted;
  float total = 0;
  for (int i = 0; i < looks.count; ++i) {
    sorted[i] = {values[i][1], looks.items[i].share * looks.items[i].share};
    total += sorted[i].second;
  }
  std::sort(sorted.begin(), sorted.begin() + looks.count);
  float below = 0;
  for (int i = 0; i < looks.count; ++i) {
    below += sorted[i].second;
    if (below >= 0.5f * total) return sorted[i].first;
  }
  return sorted[looks.count - 1].first;
}

Rgb FromLog(const Eigen::Array3f& log_colour) {
  const Eigen::Array3f rgb = log_colour.exp() - 1.0f;
  return (rgb.max(0.0f).min(255.0f) + 0.5f).cast<std::uint8_t>().matrix();
}

/// The means of the looks with the lamps' doing taken out, `unlit`, and left in, over the same looks: those that agree
/// with the median. Frontal ones, which are the sharpest, count most.
PointColours RobustColours(const Looks& looks, const LookColours& unlit) {
  const float median = MedianGreen(looks, unlit);
  Eigen::Array3f sum = Eigen::Array3f::Zero(), raw_sum = Eigen::Array3f::Zero();
  float weights = 0;
  for (int i = 0; i < looks.count; ++i) {
    const float above = unlit[i][1] - median;
    if (above > kBrighter || above < -kDarker) continue;
    const float share2 = looks.items[i].share * looks.items[i].share, share4 = share2 * share2;
    const float weight = share4 * share4;
    sum += weight * unlit[i];
    raw_sum += weight * looks.items[i].log_colour;
    weights += weight;
  }
  return {FromLog(sum / weights), FromLog(raw_sum / weights)};
}

}  // namespace

Status ColourPoints(const LevelContext& context, const std::vector<PatchMap>& maps, const std::vector<int>& owners,
                    bool remove_shading, const RunContext& run, PointCloud* cloud) {
  const Canvas canvas{*context.scene, LookCollector(context, maps), owners, *cloud};
  std::optional<Lamps> lamps;
  if (remove_shading) {
    lamps.emplace(*cloud);
    DRUPE_RETURN_IF_ERROR(lamps->FitShading(canvas, run));
    DRUPE_RETURN_IF_ERROR(lamps->FitLight(canvas, run));
  }
  cloud->colours.resize(cloud->size());
  cloud->raw_colours.resize(cloud->size());
  ProgressSpan progress(run, kAssembledShare, 1, static_cast<double>(cloud->size()));
  return ParallelFor(run, (cloud->size() + kChunk - 1) / kChunk, [&](std::size_t chunk) {
    const std::size_t end = std::min(cloud->size(), (chunk + 1) * kChunk);
    for (std::size_t i = chunk * kChunk; i < end; ++i) {
      const Looks looks = canvas.LooksAt(i);
      const PointColours colours =
          looks.count > 0 ? RobustColours(looks, lamps ? lamps->Unlit(canvas, i, looks) : AsPictured(looks))
                          : PointColours();
      cloud->colours[i] = colours.skin;
      cloud->raw_colours[i] = colours.pictured;
    }
    progress.Add(kChunk);
  });
}

}  // namespace drupe::dense
