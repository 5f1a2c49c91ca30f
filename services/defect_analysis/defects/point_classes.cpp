#include "defect_analysis/defects/point_classes.h"

#include <algorithm>
#include <cmath>
#include <iterator>

#include "image/colour.h"

namespace drupe {
namespace {

constexpr double kSkinFrom = 0.4;  // mm from a spot: what lies nearer may be tinted by the spot's own soft edge
constexpr int kSkinSteps = 2;      // cells that the ring of skin is wide which a spot is compared with

Eigen::Vector3f DeviationOf(const Eigen::Vector3f& lab, const Eigen::Vector3f& healthy, float lightness_weight) {
  return Eigen::Vector3f(lightness_weight * lab[0], lab[1], lab[2]) - healthy;
}

std::uint8_t NearestDefectClass(const Eigen::Vector3f& deviation, const std::vector<Eigen::Vector3f>& centres) {
  std::size_t nearest = 1;
  for (std::size_t k = 2; k < centres.size(); ++k) {
    if ((deviation - centres[k]).squaredNorm() < (deviation - centres[nearest]).squaredNorm()) nearest = k;
  }
  return static_cast<std::uint8_t>(nearest);
}

// Mean colours of the points in some cells.
struct MeanColours {
  Eigen::Vector3f deviation = Eigen::Vector3f::Zero();
  Eigen::Vector3f linear = Eigen::Vector3f::Zero();
  int points = 0;
};

// One spot after the other: a connected group of defect cells and the skin right beside it.
class SpotClasses {
 public:
  SpotClasses(const FruitCloud& fruit, const SkinMap& map, const SkinColours& colours, const Segmentation& segmentation,
              float lightness_weight, double min_area_mm2)
      : fruit_(fruit),
        map_(map),
        colours_(colours),
        segmentation_(segmentation),
        weight_(lightness_weight),
        min_area_(min_area_mm2),
        taken_(static_cast<std::size_t>(map.size()), 0),
        depth_(static_cast<std::size_t>(map.size()), 0),
        classes_(fruit.size(), 0) {}

  std::vector<std::uint8_t> Run() {
    for (std::int32_t cell = 0; cell < map_.size(); ++cell) {
      if (IsDefect(cell) && taken_[cell] == 0) ClassifySpot(cell);
    }
    return std::move(classes_);
  }

 private:
  bool IsDefect(std::int32_t cell) const { return segmentation_.class_of[cell] != 0; }
  Eigen::Vector3f DeviationAt(std::int32_t cell, std::uint32_t point) const {
    return DeviationOf(fruit_.lab[point], colours_.healthy[cell], weight_);
  }

  void ClassifySpot(std::int32_t seed) {
    std::vector<std::int32_t> spot = {seed};
    taken_[seed] = 1;
    Widen(spot, 0, spot.size(), true);
    const std::size_t own = spot.size();
    Widen(spot, 0, own, false);
    const std::size_t beside = spot.size();  // up to here points are classed; beyond it lies healthy skin
    double area = 0;
    for (std::size_t k = 0; k < own; ++k) area += map_.AreaOf(spot[k]);
    if (area < min_area_) return;
    const MeanColours core = MeanOf(CoreOf(spot, own));
    const MeanColours skin = MeanOf(SkinAbout({spot.begin() + static_cast<std::ptrdiff_t>(own), spot.end()}));
    if (core.points == 0) return;
    const Eigen::Vector3f way = core.deviation - skin.deviation;
    const float halfway = HalfwayOf(core, skin) * way.squaredNorm();
    const std::uint8_t defect_class = NearestDefectClass(core.deviation, segmentation_.centres);
    for (std::size_t k = 0; k < beside; ++k) {
      for (const std::uint32_t i : map_.PointsOf(spot[k])) {
        if ((DeviationAt(spot[k], i) - skin.deviation).dot(way) >= halfway) classes_[i] = defect_class;
      }
    }
  }

  // Adds the untaken neighbours of the cells from `begin` to `end`: defect cells, and theirs in turn, or skin cells.
  void Widen(std::vector<std::int32_t>& cells, std::size_t begin, std::size_t end, bool defects) {
    for (std::size_t next = begin; next < (defects ? cells.size() : end); ++next) {
      for (const std::int32_t other : map_.NeighboursOf(cells[next])) {
        if (taken_[other] != 0 || IsDefect(other) != defects) continue;
        taken_[other] = 1;
        cells.push_back(other);
      }
    }
  }

  // Skin cells next to some cells, not taken, each once.
  std::vector<std::int32_t> Around(const std::vector<std::int32_t>& cells) const {
    std::vector<std::int32_t> around;
    for (const std::int32_t cell : cells) {
      for (const std::int32_t other : map_.NeighboursOf(cell)) {
        if (taken_[other] == 0 && !IsDefect(other)) around.push_back(other);
      }
    }
    std::sort(around.begin(), around.end());
    around.erase(std::unique(around.begin(), around.end()), around.end());
    return around;
  }

  // A ring of skin cells about the cells beside a spot, clear of its edge.
  std::vector<std::int32_t> SkinAbout(const std::vector<std::int32_t>& beside) const {
    const int steps = static_cast<int>(std::ceil(kSkinFrom / map_.CellSize())) + kSkinSteps;
    std::vector<std::int32_t> within = beside, skin, near;
    for (int step = 1; step <= steps; ++step) {
      within = Around(within);
      if (step == steps - kSkinSteps) near = within;
    }
    std::set_difference(within.begin(), within.end(), near.begin(), near.end(), std::back_inserter(skin));
    return skin;
  }

  // The cells that lie deepest in the spot, whose colour its soft edge does not dilute.
  std::vector<std::int32_t> CoreOf(const std::vector<std::int32_t>& spot, std::size_t own) {
    std::vector<std::int32_t> order;  // from the rim inwards
    for (std::size_t k = 0; k < own; ++k) {
      const auto neighbours = map_.NeighboursOf(spot[k]);
      if (std::all_of(neighbours.begin(), neighbours.end(), [&](std::int32_t c) { return IsDefect(c); })) continue;
      depth_[spot[k]] = 1;
      order.push_back(spot[k]);
    }
    for (std::size_t next = 0; next < order.size(); ++next) {
      for (const std::int32_t other : map_.NeighboursOf(order[next])) {
        if (!IsDefect(other) || depth_[other] != 0) continue;
        depth_[other] = depth_[order[next]] + 1;
        order.push_back(other);
      }
    }
    if (order.empty()) return {spot.begin(), spot.begin() + static_cast<std::ptrdiff_t>(own)};  // all of the skin
    const std::int32_t least = (3 * depth_[order.back()] + 4) / 5;
    const auto first = std::find_if(order.begin(), order.end(), [&](std::int32_t c) { return depth_[c] >= least; });
    return {first, order.end()};
  }

  MeanColours MeanOf(const std::vector<std::int32_t>& cells) const {
    MeanColours mean;
    for (const std::int32_t cell : cells) {
      for (const std::uint32_t i : map_.PointsOf(cell)) {
        mean.deviation += DeviationAt(cell, i);
        mean.linear += LinearFromSrgb(fruit_.colours[i]);
        ++mean.points;
      }
    }
    mean.deviation /= static_cast<float>(std::max(1, mean.points));
    mean.linear /= static_cast<float>(std::max(1, mean.points));
    return mean;
  }

  // Where between skin (0) and core (1), along the line between their colours, the mixture of half and half lies. Blur
  // mixes light, and Lab is not linear in it.
  float HalfwayOf(const MeanColours& core, const MeanColours& skin) const {
    if (skin.points == 0) return 0.5f;
    const auto weighted = [this](const Eigen::Vector3f& linear) -> Eigen::Vector3f {
      Eigen::Vector3f lab = LabFromLinear(linear);
      lab[0] *= weight_;
      return lab;
    };
    const Eigen::Vector3f from = weighted(skin.linear), way = weighted(core.linear) - from;
    const Eigen::Vector3f middle = weighted(0.5f * (core.linear + skin.linear)) - from;
    return std::clamp(middle.dot(way) / std::max(1e-6f, way.squaredNorm()), 0.3f, 0.7f);
  }

  const FruitCloud& fruit_;
  const SkinMap& map_;
  const SkinColours& colours_;
  const Segmentation& segmentation_;
  float weight_;
  double min_area_;
  std::vector<std::uint8_t> taken_;
  std::vector<std::int32_t> depth_;  // of a spot's cells, in cells from its rim
  std::vector<std::uint8_t> classes_;
};

}  // namespace

std::vector<std::uint8_t> ClassifyPoints(const FruitCloud& fruit, const SkinMap& map, const SkinColours& colours,
                                         const Segmentation& segmentation, const SegmentationOptions& options,
                                         const ClusterOptions& cluster) {
  if (segmentation.centres.size() < 2) return std::vector<std::uint8_t>(fruit.size(), 0);
  const auto weight = static_cast<float>(options.lightness_weight);
  return SpotClasses(fruit, map, colours, segmentation, weight, cluster.min_area_mm2).Run();
}

std::vector<Eigen::Vector3f> PointDeviations(const FruitCloud& fruit, const SkinMap& map, const SkinColours& colours,
                                             const SegmentationOptions& options) {
  std::vector<Eigen::Vector3f> deviations(fruit.size());
  const auto weight = static_cast<float>(options.lightness_weight);
  for (int cell = 0; cell < map.size(); ++cell) {
    for (const std::uint32_t i : map.PointsOf(cell)) {
      deviations[i] = DeviationOf(fruit.lab[i], colours.healthy[cell], weight);
    }
  }
  return deviations;
}

}  // namespace drupe
