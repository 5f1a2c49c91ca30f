#include "defect_analysis/defects/bridge_gaps.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

namespace drupe {
namespace {

constexpr int kSweepsPerStep = 4;  // of the relaxation, for every cell of a gap's half width

// The empty cells that a morphological closing of the seen ones adds, those next to seen cells first.
std::vector<std::int32_t> GapCells(const SkinMap& map, int reach) {
  std::vector<std::uint8_t> seen(map.size()), outside(map.size());
  for (int cell = 0; cell < map.size(); ++cell) seen[cell] = map.CountOf(cell) > 0 ? 1 : 0;
  const std::vector<int> from_seen = StepsFrom(map, seen, reach);
  for (int cell = 0; cell < map.size(); ++cell) outside[cell] = from_seen[cell] > reach ? 1 : 0;
  const std::vector<int> from_outside = StepsFrom(map, outside, reach);
  std::vector<std::int32_t> gap;
  for (int cell = 0; cell < map.size(); ++cell) {
    if (seen[cell] == 0 && from_outside[cell] > reach) gap.push_back(cell);
  }
  std::stable_sort(gap.begin(), gap.end(), [&](auto a, auto b) { return from_seen[a] < from_seen[b]; });
  return gap;
}

// Mean colour of each cell's points as x, y, z; w is 1 where there is one.
std::vector<Eigen::Vector4f> CellColours(const FruitCloud& fruit, const SkinMap& map) {
  std::vector<Eigen::Vector4f> colours(map.size(), Eigen::Vector4f::Zero());
  for (int cell = 0; cell < map.size(); ++cell) {
    for (const std::uint32_t i : map.PointsOf(cell)) colours[cell] += fruit.colours[i].cast<float>().homogeneous();
    if (colours[cell].w() > 0) colours[cell] /= colours[cell].w();
  }
  return colours;
}

// Gives every cell of the gaps the mean of its neighbours, again and again: the smoothest colour between the edges.
void Spread(const SkinMap& map, const std::vector<std::int32_t>& gap, int sweeps,
            std::vector<Eigen::Vector4f>& colours) {
  for (int sweep = 0; sweep < sweeps; ++sweep) {
    for (const std::int32_t cell : gap) {
      Eigen::Vector4f sum = Eigen::Vector4f::Zero();
      for (const std::int32_t other : map.NeighboursOf(cell)) sum += colours[other];
      if (sum.w() > 0) colours[cell] = sum / sum.w();
    }
  }
}

}  // namespace

FruitCloud BridgeGaps(const FruitCloud& fruit, const SkinMap& map, double width_mm) {
  FruitCloud bridged = fruit;
  const int reach = static_cast<int>(std::ceil(0.5 * width_mm / map.CellSize()));
  if (reach == 0) return bridged;
  const std::vector<std::int32_t> gap = GapCells(map, reach);
  std::vector<Eigen::Vector4f> colours = CellColours(fruit, map);
  Spread(map, gap, kSweepsPerStep * reach, colours);
  for (const std::int32_t cell : gap) {
    const Eigen::Vector3f direction = map.map().DirectionOf(cell).cast<float>();
    const Rgb8 colour = (colours[cell].head<3>().array() + 0.5f).cast<std::uint8_t>();
    bridged.offsets.push_back(fruit.surface.RadiusAt(direction) * direction);
    bridged.colours.push_back(colour);
    bridged.lab.push_back(LabFromSrgb(colour));
  }
  return bridged;
}

}  // namespace drupe
