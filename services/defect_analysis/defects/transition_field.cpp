#include "defect_analysis/defects/transition_field.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>

#include "geometry/robust.h"

namespace drupe {
namespace {

constexpr double kSkinMargin = 2.0;      // mm of skin around the patch from which the healthy colour is taken
constexpr double kTransition = 0.45;     // mm next to the patch that may still be transition
constexpr double kReach = 0.25;          // mm beyond the patch that its outline may reach
constexpr double kBlurPerSpacing = 0.7;  // the kernel: sharp, but without holes between the points
constexpr double kStepPerBlur = 0.45;
constexpr int kMaxNodes = 4'000'000;
constexpr int kMinSkinPoints = 12;
constexpr int kMinCorePoints = 3;

struct NearbyPoint {
  Eigen::Vector2d flat;
  Eigen::Vector3d linear;  // colour in linear light
  bool in_patch = false;
  bool healthy = false;
  std::uint32_t index = 0;
};

// Cells within `distance` mm of the patch, walking from neighbour to neighbour; depth_of counts steps outside it.
std::vector<std::int32_t> CellsAround(const SkinMap& map, const Patch& patch, double distance,
                                      std::vector<int>& depth) {
  const int steps = std::max(2, static_cast<int>(std::ceil(distance / map.CellSize())));
  std::vector<std::int32_t> cells = patch.cells;
  std::vector<std::uint8_t> visited(map.size(), 0);
  depth.assign(cells.size(), 0);
  for (const std::int32_t cell : cells) visited[cell] = 1;
  for (std::size_t next = 0; next < cells.size(); ++next) {
    if (depth[next] == steps) continue;
    for (const std::int32_t other : map.NeighboursOf(cells[next])) {
      if (visited[other] != 0) continue;
      visited[other] = 1;
      cells.push_back(other);
      depth.push_back(depth[next] + 1);
    }
  }
  return cells;
}

// How many steps each of the patch's cells lies inside it; 1 at its edge.
std::vector<int> DepthInside(const SkinMap& map, const Patch& patch, int number,
                             const std::vector<std::int32_t>& patch_of) {
  std::vector<int> depth(patch.cells.size(), 0);
  std::vector<std::size_t> front;
  const auto position = [&](std::int32_t cell) {
    return static_cast<std::size_t>(std::lower_bound(patch.cells.begin(), patch.cells.end(), cell) -
                                    patch.cells.begin());
  };
  for (std::size_t i = 0; i < patch.cells.size(); ++i) {
    const auto neighbours = map.NeighboursOf(patch.cells[i]);
    const bool edge = std::any_of(neighbours.begin(), neighbours.end(),
                                  [&](std::int32_t other) { return patch_of[other] != number; });
    if (!edge) continue;
    depth[i] = 1;
    front.push_back(i);
  }
  for (std::size_t next = 0; next < front.size(); ++next) {
    for (const std::int32_t other : map.NeighboursOf(patch.cells[front[next]])) {
      if (patch_of[other] != number || depth[position(other)] != 0) continue;
      depth[position(other)] = depth[front[next]] + 1;
      front.push_back(position(other));
    }
  }
  return depth;
}

Eigen::Vector3d MiddleOf(const SkinMap& map, const Patch& patch) {
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  for (const std::int32_t cell : patch.cells) sum += map.AreaOf(cell) * map.map().DirectionOf(cell);
  return sum.normalized();
}

std::vector<NearbyPoint> Gather(const FruitCloud& fruit, const SkinMap& map, const Patch& patch, int number,
                                const std::vector<std::int32_t>& patch_of, const SkinChart& chart, double* area) {
  std::vector<int> depth;
  const std::vector<std::int32_t> cells = CellsAround(map, patch, kTransition + kSkinMargin, depth);
  const int transition = static_cast<int>(std::ceil(kTransition / map.CellSize()));
  std::vector<NearbyPoint> points;
  *area = 0;
  for (std::size_t k = 0; k < cells.size(); ++k) {
    const std::int32_t cell = cells[k];
    if (map.CountOf(cell) > 0) *area += map.AreaOf(cell);
    for (const std::uint32_t i : map.PointsOf(cell)) {
      NearbyPoint point;
      point.flat = chart.FlatFromDirection(fruit.offsets[i].cast<double>());
      point.linear = LinearFromSrgb(fruit.colours[i]).cast<double>();
      point.in_patch = patch_of[cell] == number;
      point.healthy = depth[k] > transition && patch_of[cell] == -1;
      point.index = i;
      points.push_back(point);
    }
  }
  return points;
}

// Linear-light colour of healthy skin as an affine function of the place on the map.
class HealthyColour {
 public:
  static std::optional<HealthyColour> Fit(const std::vector<NearbyPoint>& points) {
    std::vector<const NearbyPoint*> skin;
    for (const NearbyPoint& point : points) {
      if (point.healthy) skin.push_back(&point);
    }
    if (skin.size() < kMinSkinPoints) return std::nullopt;
    HealthyColour colour;
    std::vector<double> weights(skin.size(), 1);
    for (int iteration = 0; iteration < 4; ++iteration) {
      colour.Solve(skin, weights);
      std::vector<double> residuals;
      for (const NearbyPoint* p : skin) residuals.push_back((p->linear - colour.At(p->flat)).norm());
      const double scale = std::max(1e-4, Median(residuals));
      for (std::size_t i = 0; i < skin.size(); ++i) weights[i] = TukeyWeight(residuals[i] / scale);
    }
    return colour;
  }

  Eigen::Vector3d At(const Eigen::Vector2d& flat) const {
    return (coefficients_.transpose() * Eigen::Vector3d(1, flat.x(), flat.y())).cwiseMax(1e-3);
  }

 private:
  void Solve(const std::vector<const NearbyPoint*>& skin, const std::vector<double>& weights) {
    Eigen::Matrix3d normal = 1e-9 * Eigen::Matrix3d::Identity();
    Eigen::Matrix3d rhs = Eigen::Matrix3d::Zero();
    for (std::size_t i = 0; i < skin.size(); ++i) {
      const Eigen::Vector3d row(1, skin[i]->flat.x(), skin[i]->flat.y());
      normal += weights[i] * row * row.transpose();
      rhs += weights[i] * row * skin[i]->linear.transpose();
    }
    coefficients_ = normal.ldlt().solve(rhs);
  }

  Eigen::Matrix3d coefficients_ = Eigen::Matrix3d::Zero();  // a column a channel
};

// The defect's colour as a multiple of the healthy colour at the same place, which shading cancels out of: the median
// over the cells that lie deepest in the patch.
std::optional<Eigen::Vector3d> CoreRatio(const SkinMap& map, const Patch& patch, const std::vector<int>& depth,
                                         const FruitCloud& fruit, const SkinChart& chart,
                                         const HealthyColour& healthy) {
  const int deepest = *std::max_element(depth.begin(), depth.end());
  for (int from = (3 * deepest + 4) / 5; from >= 1; --from) {
    std::array<std::vector<double>, 3> ratios;
    for (std::size_t k = 0; k < patch.cells.size(); ++k) {
      if (depth[k] < from) continue;
      for (const std::uint32_t i : map.PointsOf(patch.cells[k])) {
        const Eigen::Vector3d colour = LinearFromSrgb(fruit.colours[i]).cast<double>();
        const Eigen::Vector3d skin = healthy.At(chart.FlatFromDirection(fruit.offsets[i].cast<double>()));
        for (int c = 0; c < 3; ++c) ratios[c].push_back(colour[c] / skin[c]);
      }
    }
    if (ratios[0].size() < kMinCorePoints) continue;
    return Eigen::Vector3d(Median(ratios[0]), Median(ratios[1]), Median(ratios[2]));
  }
  return std::nullopt;
}

void LayGrid(const std::vector<NearbyPoint>& points, TransitionField& field) {
  Eigen::Vector2d low = Eigen::Vector2d::Constant(1e9), high = -low;
  for (const NearbyPoint& point : points) {
    if (!point.in_patch) continue;
    low = low.cwiseMin(point.flat);
    high = high.cwiseMax(point.flat);
  }
  const double margin = kTransition + 4 * field.blur;
  field.origin = low - Eigen::Vector2d::Constant(margin);
  const Eigen::Vector2d size = high - low + Eigen::Vector2d::Constant(2 * margin);
  field.step = std::max(kStepPerBlur * field.blur, std::sqrt(size.prod() / kMaxNodes));
  field.width = static_cast<int>(size.x() / field.step) + 2;
  field.height = static_cast<int>(size.y() / field.step) + 2;
}

// What is resampled of a point: the level, and the change of the colour's three channels.
using Sample = Eigen::Vector4f;

// Normalised convolution with a Gauss kernel: the weighted mean of the points' samples at every node.
void Resample(const std::vector<NearbyPoint>& points, const std::vector<Sample>& samples, TransitionField& field) {
  const std::size_t nodes = static_cast<std::size_t>(field.width) * field.height;
  std::vector<float> weight(nodes, 1e-4f);  // so that nodes far from every point become 0
  std::vector<Sample> sums(nodes, Sample::Zero());
  const double reach = 3.2 * field.blur / field.step;
  const double falloff = 0.5 * field.step * field.step / (field.blur * field.blur);
  for (std::size_t i = 0; i < points.size(); ++i) {
    const Eigen::Vector2d place = (points[i].flat - field.origin) / field.step;
    const int x0 = std::max(0, static_cast<int>(std::ceil(place.x() - reach)));
    const int x1 = std::min(field.width - 1, static_cast<int>(std::floor(place.x() + reach)));
    const int y0 = std::max(0, static_cast<int>(std::ceil(place.y() - reach)));
    const int y1 = std::min(field.height - 1, static_cast<int>(std::floor(place.y() + reach)));
    std::array<float, 32> across;
    for (int x = x0; x <= x1 && x - x0 < 32; ++x) {
      across[x - x0] = static_cast<float>(std::exp(-falloff * (x - place.x()) * (x - place.x())));
    }
    for (int y = y0; y <= y1; ++y) {
      const auto down = static_cast<float>(std::exp(-falloff * (y - place.y()) * (y - place.y())));
      const std::size_t row = static_cast<std::size_t>(y) * field.width;
      for (int x = x0; x <= x1 && x - x0 < 32; ++x) {
        const float w = down * across[x - x0];
        sums[row + x] += w * samples[i];
        weight[row + x] += w;
      }
    }
  }
  field.level.resize(nodes);
  field.change.resize(nodes);
  for (std::size_t i = 0; i < nodes; ++i) {
    field.level[i] = sums[i][0] / weight[i];
    field.change[i] = sums[i].tail<3>() / weight[i];
  }
}

// Robust standard deviation of each channel's change over the healthy skin.
Eigen::Vector3f ChangeNoise(const std::vector<NearbyPoint>& points, const std::vector<Sample>& samples) {
  Eigen::Vector3f noise;
  for (int c = 0; c < 3; ++c) {
    std::vector<float> values;
    for (std::size_t i = 0; i < points.size(); ++i) {
      if (points[i].healthy) values.push_back(samples[i][1 + c]);
    }
    noise[c] = std::max(1e-3f, RobustSigma(std::move(values)));
  }
  return noise;
}

// Marks the patch, and makes healthy what lies beyond its reach: there uneven or shaded skin may come near the defect's
// colour, but it was not significant.
void MarkInside(const SkinMap& map, const Patch& patch, int number, const std::vector<std::int32_t>& patch_of,
                TransitionField& field) {
  std::vector<int> depth;
  const std::vector<std::int32_t> near = CellsAround(map, patch, kReach, depth);
  std::vector<std::uint8_t> is_near(map.size(), 0);
  for (const std::int32_t cell : near) is_near[cell] = 1;
  field.inside.resize(field.level.size());
  field.full_level = field.level;
  for (int row = 0; row < field.height; ++row) {
    for (int column = 0; column < field.width; ++column) {
      const Eigen::Vector3d direction = field.chart.DirectionFromFlat(field.FlatOf(column, row));
      const int cell = map.map().CellOf(direction.cast<float>());
      const std::size_t node = static_cast<std::size_t>(row) * field.width + column;
      field.inside[node] = patch_of[cell] == number ? 1 : patch_of[cell] >= 0 ? -1 : 0;
      if (is_near[cell] != 0) continue;
      field.level[node] = std::min(field.level[node], 0.0f);
      field.change[node].setZero();
    }
  }
}

}  // namespace

double TransitionField::ValueAt(const std::vector<float>& values, const Eigen::Vector2d& flat) const {
  const Eigen::Vector2d place = (flat - origin) / step;
  const int column = std::clamp(static_cast<int>(std::floor(place.x())), 0, width - 2);
  const int row = std::clamp(static_cast<int>(std::floor(place.y())), 0, height - 2);
  const double x = std::clamp(place.x() - column, 0.0, 1.0), y = std::clamp(place.y() - row, 0.0, 1.0);
  const float* node = &values[static_cast<std::size_t>(row) * width + column];
  return (1 - y) * ((1 - x) * node[0] + x * node[1]) + y * ((1 - x) * node[width] + x * node[width + 1]);
}

double TransitionField::SlopeAt(const Eigen::Vector2d& flat) const {
  const Eigen::Vector2d x(blur, 0), y(0, blur);
  return std::hypot(ValueAt(level, flat + x) - ValueAt(level, flat - x),
                    ValueAt(level, flat + y) - ValueAt(level, flat - y)) /
         (2 * blur);
}

std::optional<TransitionField> BuildTransitionField(const FruitCloud& fruit, const SkinMap& map, const Patch& patch,
                                                    int patch_number, const std::vector<std::int32_t>& patch_of) {
  TransitionField field{.chart = SkinChart(fruit.surface, MiddleOf(map, patch))};
  double area = 0;
  const std::vector<NearbyPoint> points = Gather(fruit, map, patch, patch_number, patch_of, field.chart, &area);
  const std::optional<HealthyColour> healthy = HealthyColour::Fit(points);
  if (!healthy) return std::nullopt;
  const std::vector<int> depth = DepthInside(map, patch, patch_number, patch_of);
  const auto ratio = CoreRatio(map, patch, depth, fruit, field.chart, *healthy);
  if (!ratio) return std::nullopt;

  std::vector<Sample> samples(points.size());
  std::vector<double> skin_levels;
  for (std::size_t i = 0; i < points.size(); ++i) {
    const Eigen::Vector3d skin = healthy->At(points[i].flat);
    const Eigen::Vector3d way = ratio->cwiseProduct(skin) - skin;
    const double level = (points[i].linear - skin).dot(way) / std::max(1e-9, way.squaredNorm());
    samples[i][0] = static_cast<float>(std::clamp(level, -0.5, 1.5));
    samples[i].tail<3>() = (points[i].linear.cwiseQuotient(skin).array() - 1).cast<float>();
    if (points[i].healthy) skin_levels.push_back(samples[i][0]);
    field.points += points[i].in_patch ? 1 : 0;
  }
  field.healthy_linear = healthy->At(Eigen::Vector2d::Zero());
  field.defect_linear = ratio->cwiseProduct(field.healthy_linear);
  field.healthy_lab = LabFromLinear(field.healthy_linear.cast<float>()).cast<double>();
  field.defect_lab = LabFromLinear(field.defect_linear.cast<float>()).cast<double>();
  field.noise = RobustSigma(std::move(skin_levels));
  field.spacing = std::sqrt(area / static_cast<double>(points.size()));
  field.blur = kBlurPerSpacing * field.spacing;
  LayGrid(points, field);
  Resample(points, samples, field);
  field.change_noise = ChangeNoise(points, samples);
  MarkInside(map, patch, patch_number, patch_of, field);
  return field;
}

}  // namespace drupe
