#include "reconstruction/sparse/banded_cholesky.h"

#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <random>
#include <utility>
#include <vector>

namespace drupe {
namespace {

constexpr int kBlock = 6;

/// Normal equations of views in a ring, each tied to the `reach` ones on either side, in shuffled order; with `full`,
/// one more parameter that all are tied to. Lower triangle, as the adjustment leaves it.
struct Ring {
  Eigen::MatrixXd normal;
  Eigen::VectorXd right;

  Ring(int views, int reach, bool full) {
    std::mt19937_64 random(3);
    const auto uniform = [&] { return 2 * static_cast<double>(random() >> 11) * 0x1p-53 - 1; };
    std::vector<int> place(views);
    for (int v = 0; v < views; ++v) place[v] = v;
    for (int v = views - 1; v > 0; --v) std::swap(place[v], place[random() % (v + 1)]);
    const int size = views * kBlock + (full ? 1 : 0);
    normal = 1e-3 * Eigen::MatrixXd::Identity(size, size);
    right = Eigen::VectorXd::NullaryExpr(size, uniform);
    for (int v = 0; v < views; ++v) {
      for (int step = 1; step <= reach; ++step) {
        Eigen::MatrixXd rows = Eigen::MatrixXd::Zero(8, size);
        for (const int seen : {place[v], place[(v + step) % views]}) {
          rows.middleCols(seen * kBlock, kBlock) = Eigen::MatrixXd::NullaryExpr(8, kBlock, uniform);
        }
        if (full) rows.col(size - 1) = Eigen::VectorXd::NullaryExpr(8, uniform);
        normal += rows.transpose() * rows;
      }
    }
    normal = Eigen::MatrixXd(normal.triangularView<Eigen::Lower>());
  }
};

TEST(BandedCholesky, EqualsTheDenseSolution) {
  for (const bool full : {false, true}) {
    for (const int reach : {1, 3, 20}) {
      const Ring ring(40, reach, full);
      const auto solution = SolveBanded(ring.normal, ring.right, kBlock);
      ASSERT_TRUE(solution.has_value());
      const Eigen::MatrixXd whole = ring.normal.selfadjointView<Eigen::Lower>();
      EXPECT_LT((whole * *solution - ring.right).norm(), 1e-9 * ring.right.norm());
    }
  }
}

TEST(BandedCholesky, SolvesPartsThatAreNotTied) {
  Ring ring(30, 2, false);
  ring.normal.bottomLeftCorner(15 * kBlock, 15 * kBlock).setZero();
  ring.normal.diagonal().array() += 50;
  const auto solution = SolveBanded(ring.normal, ring.right, kBlock);
  ASSERT_TRUE(solution.has_value());
  const Eigen::MatrixXd whole = ring.normal.selfadjointView<Eigen::Lower>();
  EXPECT_LT((whole * *solution - ring.right).norm(), 1e-9 * ring.right.norm());
}

TEST(BandedCholesky, RefusesWhatIsNotPositiveDefinite) {
  Ring ring(20, 2, true);
  ring.normal(7, 7) = -1;
  EXPECT_FALSE(SolveBanded(ring.normal, ring.right, kBlock).has_value());
  Ring other(20, 2, true);
  other.normal(20 * kBlock, 20 * kBlock) = 0;
  EXPECT_FALSE(SolveBanded(other.normal, other.right, kBlock).has_value());
}

}  // namespace
}  // namespace drupe
