#include "reconstruction/dense/surface_grid.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <numeric>

namespace drupe::dense {
namespace {

/// Points half a unit apart on the plane z = 0.25, 0 <= x, y < 10.
std::vector<Eigen::Vector3f> Floor() {
  std::vector<Eigen::Vector3f> positions;
  for (int y = 0; y < 20; ++y) {
    for (int x = 0; x < 20; ++x) positions.emplace_back(0.5f * x, 0.5f * y, 0.25f);
  }
  return positions;
}

float Total(const SurfaceGrid::Place& place) {
  return std::accumulate(place.weights.begin(), place.weights.end(), 0.0f);
}

TEST(SurfaceGrid, HasACellWhereThereArePoints) {
  const SurfaceGrid grid(Floor(), 2);
  EXPECT_EQ(grid.cell_count(), 25);
  EXPECT_EQ(grid.CellOf({0.1f, 0.1f, 0.3f}), grid.CellOf({1.9f, 1.9f, 0.3f}));
  EXPECT_NE(grid.CellOf({0.1f, 0.1f, 0.3f}), grid.CellOf({2.1f, 0.1f, 0.3f}));
  EXPECT_EQ(grid.CellOf({0.1f, 0.1f, 5}), SurfaceGrid::kNone);
  EXPECT_EQ(grid.CellOf({-0.1f, 0.1f, 0.3f}), SurfaceGrid::kNone);
}

TEST(SurfaceGrid, WeighsTheCellsAboutAPlaceByTheirDistance) {
  const SurfaceGrid grid(Floor(), 2);
  const SurfaceGrid::Place middle = grid.At({3, 3, 1.25f});  // of one cell, in its upper half
  EXPECT_NEAR(Total(middle), 1, 1e-5);
  EXPECT_NEAR(*std::max_element(middle.weights.begin(), middle.weights.end()), 1, 1e-5);
  const SurfaceGrid::Place between = grid.At({4, 3, 1.25f});
  EXPECT_NEAR(Total(between), 1, 1e-5);
  EXPECT_EQ(std::count_if(between.weights.begin(), between.weights.end(), [](float w) { return w > 0.4f; }), 2);
  EXPECT_LT(Total(grid.At({3, 3, 2.75f})), 0.5f);  // above the floor, where the cells are empty
  EXPECT_EQ(Total(grid.At({300, 300, 300})), 0);
}

TEST(SurfaceGrid, KnowsWhichCellsTouch) {
  const SurfaceGrid grid(Floor(), 2);
  EXPECT_EQ(grid.Around(grid.CellOf({5, 5, 0.25f})).size(), 8u);
  EXPECT_EQ(grid.Around(grid.CellOf({0, 0, 0.25f})).size(), 3u);
}

TEST(SurfaceGrid, MakesItsCubesLargerWhereAFarPointWouldTakeAllMemory) {
  std::vector<Eigen::Vector3f> positions = Floor();
  positions.emplace_back(1e6f, 1e6f, 1e6f);
  const SurfaceGrid grid(positions, 2);
  EXPECT_EQ(grid.cell_count(), 2);
  EXPECT_NE(grid.CellOf(positions.front()), SurfaceGrid::kNone);
  EXPECT_NE(grid.CellOf(positions.back()), SurfaceGrid::kNone);
}

TEST(SurfaceGrid, OfNothingHasNoCells) {
  EXPECT_EQ(SurfaceGrid({}, 2).cell_count(), 0);
}

}  // namespace
}  // namespace drupe::dense
