#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <random>

#include "geometry/cube_map.h"
#include "geometry/spherical_harmonics.h"

namespace drupe {
namespace {

std::vector<Eigen::Vector3d> CellDirections(const CubeMap& map) {
  std::vector<Eigen::Vector3d> directions;
  for (int cell = 0; cell < map.size(); ++cell) directions.push_back(map.DirectionOf(cell));
  return directions;
}

TEST(CubeMap, EveryCellHoldsItsOwnMiddle) {
  for (const int n : {1, 2, 7, 32}) {
    const CubeMap map(n);
    for (int cell = 0; cell < map.size(); ++cell) {
      ASSERT_EQ(map.CellOf(map.DirectionOf(cell).cast<float>()), cell);
    }
  }
}

TEST(CubeMap, CellsCoverTheSphereOnce) {
  const CubeMap map(20);
  double sum = 0, smallest = 10, largest = 0;
  for (int cell = 0; cell < map.size(); ++cell) {
    const double angle = map.SolidAngle(cell);
    sum += angle;
    smallest = std::min(smallest, angle);
    largest = std::max(largest, angle);
  }
  EXPECT_NEAR(sum, 4 * std::numbers::pi, 1e-9);
  EXPECT_LT(largest / smallest, 1.42);
}

TEST(CubeMap, NeighboursTouchAcrossEdges) {
  const CubeMap map(16);
  for (int cell = 0; cell < map.size(); ++cell) {
    for (const auto& [columns, rows] : {std::pair{1, 0}, {-1, 0}, {0, 1}, {0, -1}}) {
      const int other = map.Neighbour(cell, columns, rows);
      ASSERT_NE(other, cell);
      const double angle = std::acos(map.DirectionOf(cell).dot(map.DirectionOf(other)));
      ASSERT_LT(angle, 1.5 * map.CellAngle());
    }
  }
}

TEST(SphericalHarmonics, BasisIsOrthonormal) {
  const CubeMap map(40);
  const Eigen::MatrixXd basis = SphericalBasisRows(6, CellDirections(map));
  Eigen::VectorXd angles(map.size());
  for (int cell = 0; cell < map.size(); ++cell) angles[cell] = map.SolidAngle(cell);
  const Eigen::MatrixXd gram = basis.transpose() * angles.asDiagonal() * basis;
  EXPECT_LT((gram - Eigen::MatrixXd::Identity(49, 49)).cwiseAbs().maxCoeff(), 5e-3);
}

TEST(SphericalHarmonics, FitReturnsTheFunction) {
  const CubeMap map(16);
  const std::vector<Eigen::Vector3d> directions = CellDirections(map);
  Eigen::MatrixXd values(map.size(), 2);
  for (int i = 0; i < map.size(); ++i) {
    const Eigen::Vector3d& d = directions[i];
    values.row(i) << 10 + d.x() + 2 * d.y() * d.z(), d.z() * d.z() * d.x();
  }
  const auto fit =
      FitSphericalFunction(6, SphericalBasisRows(6, directions), values, Eigen::VectorXd::Ones(map.size()), 1e-9);
  ASSERT_TRUE(fit.ok());
  const Eigen::Vector3d d = Eigen::Vector3d(0.3, -0.5, 0.8).normalized();
  EXPECT_NEAR(fit->At(d)[0], 10 + d.x() + 2 * d.y() * d.z(), 1e-3);
  EXPECT_NEAR(fit->At(d)[1], d.z() * d.z() * d.x(), 1e-3);
}

TEST(SphericalHarmonics, UnseenCapContinuesSmoothly) {
  const CubeMap map(24);
  const std::vector<Eigen::Vector3d> directions = CellDirections(map);
  Eigen::MatrixXd values(map.size(), 1);
  Eigen::VectorXd weights(map.size());
  const auto radius = [](const Eigen::Vector3d& d) { return 18 + 0.8 * d.z() * d.z() + 0.3 * d.x(); };
  for (int i = 0; i < map.size(); ++i) {
    values(i, 0) = radius(directions[i]);
    weights[i] = directions[i].z() > -0.75 ? 1.0 : 0.0;
  }
  const auto fit = FitSphericalFunction(12, SphericalBasisRows(12, directions), values, weights, 1e-9);
  ASSERT_TRUE(fit.ok());
  EXPECT_NEAR(fit->At(-Eigen::Vector3d::UnitZ())[0], radius(-Eigen::Vector3d::UnitZ()), 0.15);
}

TEST(SphericalHarmonics, NothingSeenIsAnError) {
  const CubeMap map(4);
  const Eigen::MatrixXd values = Eigen::MatrixXd::Zero(map.size(), 1);
  const auto fit = FitSphericalFunction(2, SphericalBasisRows(2, CellDirections(map)), values,
                                        Eigen::VectorXd::Zero(map.size()), 1e-9);
  ASSERT_FALSE(fit.ok());
  EXPECT_EQ(fit.status().code(), "too_few_directions");
}

}  // namespace
}  // namespace drupe
