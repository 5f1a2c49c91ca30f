#include "defect_analysis/defects/point_classes.h"

#include <algorithm>

namespace drupe {
namespace {

Eigen::Vector3f DeviationOf(const Eigen::Vector3f& lab, const Eigen::Vector3f& healthy, float lightness_weight) {
  return Eigen::Vector3f(lightness_weight * lab[0], lab[1], lab[2]) - healthy;
}

std::uint8_t NearestClass(const Eigen::Vector3f& deviation, const std::vector<Eigen::Vector3f>& centres) {
  std::size_t nearest = 0;
  for (std::size_t k = 1; k < centres.size(); ++k) {
    if ((deviation - centres[k]).squaredNorm() < (deviation - centres[nearest]).squaredNorm()) nearest = k;
  }
  return static_cast<std::uint8_t>(nearest);
}

bool BordersDefect(const SkinMap& map, const Segmentation& segmentation, int cell) {
  if (segmentation.class_of[cell] != 0) return true;
  const auto neighbours = map.NeighboursOf(cell);
  return std::any_of(neighbours.begin(), neighbours.end(),
                     [&](std::int32_t other) { return segmentation.class_of[other] != 0; });
}

}  // namespace

std::vector<std::uint8_t> ClassifyPoints(const FruitCloud& fruit, const SkinMap& map, const SkinColours& colours,
                                         const Segmentation& segmentation, const SegmentationOptions& options) {
  std::vector<std::uint8_t> classes(fruit.size(), 0);
  if (segmentation.centres.size() < 2) return classes;
  const auto weight = static_cast<float>(options.lightness_weight);
  for (int cell = 0; cell < map.size(); ++cell) {
    if (map.CountOf(cell) == 0 || !BordersDefect(map, segmentation, cell)) continue;
    for (const std::uint32_t i : map.PointsOf(cell)) {
      classes[i] = NearestClass(DeviationOf(fruit.lab[i], colours.healthy[cell], weight), segmentation.centres);
    }
  }
  return classes;
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
