#include "reconstruction/sparse/banded_cholesky.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace drupe {
namespace {

constexpr Eigen::Index kPanel = 48;  ///< columns that are factorised at once

/// Per block, the other ones that it is tied to.
using Ties = std::vector<std::vector<int>>;

Ties TiesOf(const Eigen::MatrixXd& normal, int block, int count) {
  Ties ties(count);
  for (int column = 0; column < count; ++column) {
    for (int row = column + 1; row < count; ++row) {
      if (normal.block(row * block, column * block, block, block).isZero(0)) continue;
      ties[row].push_back(column);
      ties[column].push_back(row);
    }
  }
  return ties;
}

/// Appends `start` and all that is tied to it to `order`, breadth first, those with few ties before those with many.
void Spread(int start, const Ties& ties, std::vector<std::uint8_t>& is_placed, std::vector<int>& order) {
  std::size_t next = order.size();
  order.push_back(start);
  is_placed[start] = 1;
  for (; next < order.size(); ++next) {
    const auto added = static_cast<std::ptrdiff_t>(order.size());
    for (const int other : ties[order[next]]) {
      if (is_placed[other]) continue;
      is_placed[other] = 1;
      order.push_back(other);
    }
    std::stable_sort(order.begin() + added, order.end(), [&](int a, int b) { return ties[a].size() < ties[b].size(); });
  }
}

/// Cuthill and McKee's order, reversed. It begins at a block that is as far as any from another one.
std::vector<int> NarrowOrder(const Ties& ties) {
  std::vector<std::uint8_t> is_placed(ties.size(), 0);
  std::vector<int> order;
  for (std::size_t block = 0; block < ties.size(); ++block) {
    if (is_placed[block]) continue;
    std::vector<std::uint8_t> is_seen = is_placed;
    std::vector<int> component;
    Spread(static_cast<int>(block), ties, is_seen, component);
    Spread(component.back(), ties, is_placed, order);
  }
  std::reverse(order.begin(), order.end());
  return order;
}

/// The matrix of the blocks in another order (lower triangle), its right sides, and per block where its column ends.
struct Banded {
  Eigen::MatrixXd matrix;
  Eigen::MatrixXd rights;
  std::vector<int> last;  ///< block of the last entry that is not zero, of this and all columns before
};

Banded Reordered(const Eigen::MatrixXd& normal, const Eigen::MatrixXd& rights, const Ties& ties,
                 const std::vector<int>& order, int block) {
  const int count = static_cast<int>(order.size());
  std::vector<int> place(count);
  for (int k = 0; k < count; ++k) place[order[k]] = k;
  Banded banded{Eigen::MatrixXd::Zero(count * block, count * block), Eigen::MatrixXd(count * block, rights.cols()), {}};
  for (int k = 0; k < count; ++k) {
    const int from = order[k];
    banded.matrix.block(k * block, k * block, block, block) = normal.block(from * block, from * block, block, block);
    banded.rights.middleRows(k * block, block) = rights.middleRows(from * block, block);
    int last = banded.last.empty() ? k : std::max(k, banded.last.back());
    for (const int other : ties[from]) {
      const int row = place[other];
      if (row < k) continue;
      last = std::max(last, row);
      // The upper triangle of `normal` is empty: there, the lower one's block is turned over.
      if (other > from) {
        banded.matrix.block(row * block, k * block, block, block) =
            normal.block(other * block, from * block, block, block);
      } else {
        banded.matrix.block(row * block, k * block, block, block) =
            normal.block(from * block, other * block, block, block).transpose();
      }
    }
    banded.last.push_back(last);
  }
  return banded;
}

/// Overwrites the lower triangle by its Cholesky factor, panel by panel. False when it is not positive definite.
bool Factorise(const std::vector<int>& last, int block, Eigen::MatrixXd& matrix) {
  for (Eigen::Index start = 0; start < matrix.rows(); start += kPanel) {
    const Eigen::Index width = std::min(kPanel, matrix.rows() - start), next = start + width;
    const Eigen::Index below = block * (last[(next - 1) / block] + 1) - next;
    Eigen::Ref<Eigen::MatrixXd> own = matrix.block(start, start, width, width);
    const Eigen::LLT<Eigen::Ref<Eigen::MatrixXd>> factor(own);
    if (factor.info() != Eigen::Success) return false;
    if (below == 0) continue;
    Eigen::Ref<Eigen::MatrixXd> under = matrix.block(next, start, below, width);
    own.triangularView<Eigen::Lower>().transpose().solveInPlace<Eigen::OnTheRight>(under);
    matrix.block(next, next, below, below).selfadjointView<Eigen::Lower>().rankUpdate(under, -1);
  }
  return true;
}

/// Solutions of the blocks' part for several right sides.
std::optional<Eigen::MatrixXd> SolveBlocks(const Eigen::MatrixXd& normal, const Eigen::MatrixXd& rights, int block) {
  const int count = static_cast<int>(rights.rows()) / block;
  const Ties ties = TiesOf(normal, block, count);
  const std::vector<int> order = NarrowOrder(ties);
  Banded banded = Reordered(normal, rights, ties, order, block);
  if (!Factorise(banded.last, block, banded.matrix)) return std::nullopt;
  banded.matrix.triangularView<Eigen::Lower>().solveInPlace(banded.rights);
  banded.matrix.transpose().triangularView<Eigen::Upper>().solveInPlace(banded.rights);
  Eigen::MatrixXd solutions(rights.rows(), rights.cols());
  for (int k = 0; k < count; ++k) {
    solutions.middleRows(order[k] * block, block) = banded.rights.middleRows(k * block, block);
  }
  return solutions;
}

}  // namespace

std::optional<Eigen::VectorXd> SolveBanded(const Eigen::MatrixXd& normal, const Eigen::VectorXd& right, int block) {
  const Eigen::Index blocks = normal.rows() / block * block;
  const bool has_full_row = blocks < normal.rows();
  // The full row would tie everything to everything: it is solved for after the blocks.
  Eigen::MatrixXd rights(blocks, has_full_row ? 2 : 1);
  rights.col(0) = right.head(blocks);
  if (has_full_row) rights.col(1) = normal.row(blocks).head(blocks).transpose();
  const std::optional<Eigen::MatrixXd> solved = SolveBlocks(normal, rights, block);
  if (!solved) return std::nullopt;
  if (!has_full_row) return solved->col(0);
  const auto coupling = normal.row(blocks).head(blocks);
  const double pivot = normal(blocks, blocks) - coupling.dot(solved->col(1));
  if (!(pivot > 0)) return std::nullopt;
  Eigen::VectorXd solution(normal.rows());
  solution[blocks] = (right[blocks] - coupling.dot(solved->col(0))) / pivot;
  solution.head(blocks) = solved->col(0) - solution[blocks] * solved->col(1);
  return solution;
}

}  // namespace drupe
