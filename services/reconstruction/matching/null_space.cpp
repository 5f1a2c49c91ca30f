#include "reconstruction/matching/null_space.h"

#include <array>

#include "geometry/reflection.h"

namespace drupe {
namespace {

constexpr int kEntries = 9;
using EntryVector = std::array<double, kEntries>;  ///< of a matrix, row by row

EntryVector EpipolarConstraint(const PointPair& pair) {
  const double first[] = {pair.first.x(), pair.first.y(), 1}, second[] = {pair.second.x(), pair.second.y(), 1};
  EntryVector constraint;
  for (int i = 0; i < kEntries; ++i) constraint[i] = second[i / 3] * first[i % 3];
  return constraint;
}

}  // namespace

std::vector<Eigen::Matrix3d> EpipolarNullSpace(std::span<const PointPair> pairs) {
  // The last columns of Q of the QR decomposition of the constraints.
  const int count = static_cast<int>(pairs.size());
  std::vector<Reflection> reflections;
  reflections.reserve(pairs.size());
  for (const PointPair& pair : pairs) {
    EntryVector constraint = EpipolarConstraint(pair);
    for (std::size_t k = 0; k < reflections.size(); ++k) reflections[k].Apply(constraint.data() + k);
    const int done = static_cast<int>(reflections.size());
    reflections.emplace_back(constraint.data() + done, kEntries - done);
  }
  std::vector<Eigen::Matrix3d> basis(kEntries - count);
  for (int b = 0; b < kEntries - count; ++b) {
    EntryVector column{};
    column[count + b] = 1;
    for (int k = count - 1; k >= 0; --k) reflections[k].Apply(column.data() + k);
    for (int i = 0; i < kEntries; ++i) basis[b](i / 3, i % 3) = column[i];
  }
  return basis;
}

}  // namespace drupe
