#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <random>

#include "geometry/homography_fit.h"
#include "geometry/reflection.h"
#include "geometry/small_eigen.h"
#include "geometry/solve_symmetric.h"
#include "geometry/symmetric_eigen.h"

namespace drupe {
namespace {

SmallMatrix RandomSquare(int size, std::uint64_t seed) {
  std::mt19937_64 random(seed);
  SmallMatrix matrix(size, size);
  for (int i = 0; i < size * size; ++i) matrix.data()[i] = static_cast<double>(random() % 2001) / 1000 - 1;
  return matrix;
}

TEST(Reflection, TurnsItsVectorOntoTheFirstAxisAndKeepsLengths) {
  const double vector[] = {3, -4, 12, 84};
  const Reflection reflection(vector, 4);
  double turned[] = {3, -4, 12, 84}, other[] = {1, 2, 0, -2};
  reflection.Apply(turned);
  reflection.Apply(other);
  EXPECT_NEAR(turned[0], -85, 1e-12);
  for (int i = 1; i < 4; ++i) EXPECT_NEAR(turned[i], 0, 1e-12);
  EXPECT_NEAR(other[0] * other[0] + other[1] * other[1] + other[2] * other[2] + other[3] * other[3], 9, 1e-12);
}

TEST(Reflection, LeavesWhatLiesOnTheAxis) {
  const double vector[] = {-2, 0, 0};
  double x[] = {5, 6, 7};
  Reflection(vector, 3).Apply(x);
  EXPECT_EQ(x[0], 5);
  EXPECT_EQ(x[2], 7);
}

TEST(RealEigenvalues, SolveTheCharacteristicEquation) {
  for (std::uint64_t seed = 0; seed < 50; ++seed) {
    const SmallMatrix matrix = RandomSquare(10, seed);
    for (const double value : RealEigenvalues(matrix, 1e-9)) {
      SmallMatrix shifted = matrix;
      for (int i = 0; i < 10; ++i) shifted(i, i) -= value;
      const SmallVector x = NullVector(shifted);
      EXPECT_LT((shifted.lazyProduct(x)).norm(), 1e-10 * x.norm()) << seed;
    }
  }
}

TEST(RealEigenvalues, AreAllOfASymmetricMatrix) {
  SmallMatrix matrix = RandomSquare(8, 1);
  for (int r = 0; r < 8; ++r) {
    for (int c = 0; c < r; ++c) matrix(c, r) = matrix(r, c);
  }
  std::vector<double> values = RealEigenvalues(matrix, 1e-9);
  std::sort(values.begin(), values.end());
  const SymmetricEigen expected = DecomposeSymmetric(matrix);
  ASSERT_EQ(values.size(), 8u);
  for (int i = 0; i < 8; ++i) EXPECT_NEAR(values[i], expected.values[i], 1e-12);
}

TEST(RealEigenvalues, RefuseWhatIsNoNumber) {
  SmallMatrix matrix = RandomSquare(4, 1);
  matrix(2, 1) = std::nan("");
  EXPECT_TRUE(RealEigenvalues(matrix, 1e-9).empty());
}

TEST(RealRoots, LeaveOutComplexOnes) {
  const double cubic[] = {-2, 3, -1, 0.5};  // (x - r) times a quadratic without real roots
  const std::vector<double> one = RealRoots(cubic, 1e-9);
  ASSERT_EQ(one.size(), 1u);
  const double x = one[0];
  EXPECT_NEAR(-2 + 3 * x - x * x + 0.5 * x * x * x, 0, 1e-12);
}

TEST(RealRoots, FindDoubleOnesToHalfTheDigits) {
  const double quartic[] = {4, 0, -8, 0, 4};  // 4 (x - 1)^2 (x + 1)^2
  std::vector<double> roots = RealRoots(quartic, 1e-4);
  std::sort(roots.begin(), roots.end());
  ASSERT_EQ(roots.size(), 4u);
  for (int i = 0; i < 4; ++i) EXPECT_NEAR(roots[i], i < 2 ? -1 : 1, 1e-6);
}

TEST(SolveSymmetric, SolvesAndReadsTheLowerTriangleOnly) {
  Eigen::Matrix<double, 5, 5> root = RandomSquare(5, 3);
  const Eigen::Matrix<double, 5, 5> normal = root * root.transpose();
  const Eigen::Matrix<double, 5, 1> x(1, -2, 3, 0.5, 4), right = normal * x;
  EXPECT_LT((SolveSymmetric<5>(normal.triangularView<Eigen::Lower>(), right) - x).norm(), 1e-9);
}

TEST(SolveSymmetric, LeavesZeroWhatNothingDetermines) {
  Eigen::Matrix3d normal = Eigen::Matrix3d::Zero();
  normal(0, 0) = 1e12;
  normal(2, 2) = 1e-12;
  EXPECT_EQ(SolveSymmetric<3>(normal, Eigen::Vector3d(2e12, 5, 3e-12)), Eigen::Vector3d(2, 0, 3));
}

TEST(HomographyFit, FindsTheHomographyOfExactPlaces) {
  Eigen::Matrix3d truth;
  truth << 1, 0.2, -0.1, 0.05, 0.9, 0.3, 0.1, -0.2, 1;
  HomographyFit fit;
  for (const auto& [x, y] : {std::pair(-1.0, -1.0), {1.0, -0.8}, {0.9, 1.0}, {-1.0, 0.7}, {0.2, 0.1}}) {
    fit.Add({x, y}, (truth * Eigen::Vector3d(x, y, 1)).hnormalized());
  }
  const Eigen::Matrix3d found = fit.Solve();
  EXPECT_NEAR(found.norm(), 1, 1e-12);
  EXPECT_LT((found / found(2, 2) - truth).norm(), 1e-9);
}

}  // namespace
}  // namespace drupe
