#include <algorithm>
#include <array>
#include <cmath>

#include "defect_analysis/defects/contour.h"

namespace drupe {
namespace {

// One connected region of nodes at or above the level, holes filled.
struct Region {
  std::vector<std::uint8_t> mask;
  int nodes = 0;
  bool overlaps_patch = false;
};

constexpr std::array<std::pair<int, int>, 4> kSides = {{{1, 0}, {0, 1}, {-1, 0}, {0, -1}}};

class Tracer {
 public:
  Tracer(const TransitionField& field, double level) : field_(field), level_(static_cast<float>(level)) {}

  std::vector<Polygon> Run(double min_area_mm2) {
    std::vector<std::uint8_t> visited(field_.level.size(), 0);
    std::vector<std::pair<int, Polygon>> found;
    const double node_area = field_.step * field_.step;
    for (std::size_t seed = 0; seed < visited.size(); ++seed) {
      if (visited[seed] != 0 || field_.level[seed] < level_) continue;
      Region region = Flood(static_cast<int>(seed), visited);
      if (!region.overlaps_patch || region.nodes * node_area < min_area_mm2) continue;
      FillHoles(region);
      Polygon polygon = Follow(region);
      if (polygon.size() >= 6) found.emplace_back(region.nodes, std::move(polygon));
    }
    std::stable_sort(found.begin(), found.end(), [](const auto& a, const auto& b) { return a.first > b.first; });
    std::vector<Polygon> polygons;
    for (auto& [nodes, polygon] : found) polygons.push_back(std::move(polygon));
    return polygons;
  }

 private:
  int Index(int column, int row) const { return row * field_.width + column; }
  bool IsInside(int column, int row) const {
    return column >= 0 && row >= 0 && column < field_.width && row < field_.height;
  }

  Region Flood(int seed, std::vector<std::uint8_t>& visited) const {
    Region region;
    region.mask.assign(visited.size(), 0);
    std::vector<int> stack = {seed};
    visited[seed] = 1;
    while (!stack.empty()) {
      const int node = stack.back();
      stack.pop_back();
      region.mask[node] = 1;
      ++region.nodes;
      region.overlaps_patch |= field_.inside[node] > 0;
      for (const auto& [dx, dy] : kSides) {
        const int column = node % field_.width + dx, row = node / field_.width + dy;
        if (!IsInside(column, row)) continue;
        const int other = Index(column, row);
        if (visited[other] != 0 || field_.level[other] < level_) continue;
        visited[other] = 1;
        stack.push_back(other);
      }
    }
    return region;
  }

  // What the outside cannot reach is part of the region.
  void FillHoles(Region& region) const {
    std::vector<std::uint8_t> outside(region.mask.size(), 0);
    std::vector<int> stack;
    const auto visit = [&](int column, int row) {
      if (!IsInside(column, row)) return;
      const int node = Index(column, row);
      if (outside[node] != 0 || region.mask[node] != 0) return;
      outside[node] = 1;
      stack.push_back(node);
    };
    for (int column = 0; column < field_.width; ++column) {
      visit(column, 0);
      visit(column, field_.height - 1);
    }
    for (int row = 0; row < field_.height; ++row) {
      visit(0, row);
      visit(field_.width - 1, row);
    }
    while (!stack.empty()) {
      const int node = stack.back();
      stack.pop_back();
      for (const auto& [dx, dy] : kSides) visit(node % field_.width + dx, node / field_.width + dy);
    }
    for (std::size_t i = 0; i < region.mask.size(); ++i) region.mask[i] = outside[i] == 0 ? 1 : 0;
  }

  bool Has(const Region& region, int column, int row) const {
    return IsInside(column, row) && region.mask[Index(column, row)] != 0;
  }

  // Where the field crosses the level between a node in the region and its neighbour outside.
  Eigen::Vector2d Crossing(int column, int row, int dx, int dy) const {
    const float inner = std::max(field_.level[Index(column, row)], level_);
    const float outer = IsInside(column + dx, row + dy) ? field_.level[Index(column + dx, row + dy)] : 0.0f;
    const double share = outer < level_ ? (inner - level_) / std::max(1e-6f, inner - outer) : 0.5;
    return field_.FlatOf(column + share * dx, row + share * dy);
  }

  // Walks along the edges between nodes inside and outside, the region on the left; every edge gives one crossing.
  Polygon Follow(const Region& region) const {
    const auto first = std::find(region.mask.begin(), region.mask.end(), 1);
    const int start = static_cast<int>(first - region.mask.begin());
    const int column0 = start % field_.width, row0 = start / field_.width;
    int column = column0, row = row0, side = 3;  // the first node in reading order has nothing above it
    Polygon polygon;
    do {
      const auto& [dx, dy] = kSides[side];
      polygon.push_back(Crossing(column, row, dx, dy));
      const auto& [fx, fy] = kSides[(side + 1) % 4];  // along the boundary
      if (Has(region, column + dx + fx, row + dy + fy) && Has(region, column + fx, row + fy)) {
        column += dx + fx;
        row += dy + fy;
        side = (side + 3) % 4;
      } else if (Has(region, column + fx, row + fy)) {
        column += fx;
        row += fy;
      } else {
        side = (side + 1) % 4;
      }
    } while (column != column0 || row != row0 || side != 3);
    return polygon;
  }

  const TransitionField& field_;
  float level_;
};

}  // namespace

std::vector<Polygon> TraceBoundaries(const TransitionField& field, double level, double min_area_mm2) {
  return Tracer(field, level).Run(min_area_mm2);
}

}  // namespace drupe
