#include "defect_analysis/defects/healthy_skin.h"

#include <algorithm>
#include <cmath>

#include "geometry/cube_table.h"
#include "geometry/robust.h"
#include "geometry/spherical_harmonics.h"

namespace drupe {
namespace {

constexpr int kFitCells = 32;                // a side of a face: cells of about 0.9 mm on a plum
constexpr std::size_t kFitPoints = 400'000;  // that the medians are taken of: about 70 a cell
constexpr int kTableCells = 48;              // of the healthy colour's table
constexpr int kDegree = 10;                  // finest healthy structure: a tenth of the circumference
constexpr double kSmoothness = 1e-7;
constexpr double kMinScale = 1.5;  // weighted colour difference below which nothing is called an outlier

struct CellMedians {
  std::vector<Eigen::Vector3d> directions;
  Eigen::MatrixXd lab;  // a row a cell, L already weighted
};

CellMedians MedianColours(const FruitCloud& fruit, float lightness_weight) {
  const CubeMap map(kFitCells);
  std::vector<std::vector<std::uint32_t>> points(map.size());
  const std::size_t step = std::max<std::size_t>(1, fruit.size() / kFitPoints);
  for (std::size_t i = 0; i < fruit.size(); i += step) {
    points[map.CellOf(fruit.offsets[i])].push_back(static_cast<std::uint32_t>(i));
  }
  CellMedians medians;
  std::vector<Eigen::Vector3d> colours;
  for (int cell = 0; cell < map.size(); ++cell) {
    if (points[cell].empty()) continue;
    Eigen::Vector3d colour;
    for (int channel = 0; channel < 3; ++channel) {
      std::vector<float> values;
      for (const std::uint32_t i : points[cell]) values.push_back(fruit.lab[i][channel]);
      colour[channel] = Median(std::move(values));
    }
    colour[0] *= lightness_weight;
    colours.push_back(colour);
    medians.directions.push_back(map.DirectionOf(cell));
  }
  medians.lab.resize(static_cast<Eigen::Index>(colours.size()), 3);
  for (std::size_t i = 0; i < colours.size(); ++i)
    medians.lab.row(static_cast<Eigen::Index>(i)) = colours[i].transpose();
  return medians;
}

Eigen::Vector3d MedianRow(const Eigen::MatrixXd& rows) {
  Eigen::Vector3d median;
  for (int c = 0; c < 3; ++c) median[c] = Median(std::vector<double>(rows.col(c).begin(), rows.col(c).end()));
  return median;
}

Eigen::VectorXd Weights(const Eigen::MatrixXd& residuals) {
  const Eigen::VectorXd distances = residuals.rowwise().norm();
  const double scale = std::max(kMinScale, Median(std::vector<double>(distances.begin(), distances.end())));
  return distances.unaryExpr([scale](double d) { return TukeyWeight(d / scale); });
}

Result<SphericalFunction> FitHealthy(const CellMedians& cells) {
  if (cells.directions.empty()) return Unprocessable("too_few_directions", "the fruit has no points");
  const Eigen::MatrixXd basis = SphericalBasisRows(kDegree, cells.directions);
  Eigen::VectorXd weights = Weights(cells.lab.rowwise() - MedianRow(cells.lab).transpose());
  SphericalFunction healthy;
  for (const int degree : {1, 1, 2, 2, 4, 4, 7, kDegree, kDegree}) {
    DRUPE_ASSIGN_OR_RETURN(healthy, FitSphericalFunction(degree, basis, cells.lab, weights, kSmoothness));
    weights = Weights(cells.lab - basis.leftCols((degree + 1) * (degree + 1)) * healthy.coefficients());
  }
  return healthy;
}

// Mean Lab of each cell's points, as x, y, z, and their number, as w.
std::vector<Eigen::Vector4f> CellSums(const FruitCloud& fruit, const SkinMap& map, float lightness_weight) {
  std::vector<Eigen::Vector4f> sums(map.size(), Eigen::Vector4f::Zero());
  for (int cell = 0; cell < map.size(); ++cell) {
    for (const std::uint32_t i : map.PointsOf(cell)) {
      const Eigen::Vector3f& lab = fruit.lab[i];
      sums[cell] += Eigen::Vector4f(lightness_weight * lab[0], lab[1], lab[2], 1);
    }
  }
  return sums;
}

// The 3 x 3 binomial mean, weighted by the number of points, which also fills cells between points.
Eigen::Vector4f Smooth(const std::vector<Eigen::Vector4f>& sums, const SkinMap& map, int cell) {
  const auto neighbours = map.NeighboursOf(cell);
  Eigen::Vector4f sum = 4 * sums[cell];
  for (int k = 0; k < 4; ++k) sum += 2 * sums[neighbours[k]];
  for (int k = 4; k < 8; ++k) sum += sums[neighbours[k]];
  return sum;
}

// The table's value at the middle of a cell of `map`: no angles are needed, since both divide a face evenly.
Eigen::Vector3f AtCell(const CubeTable<Eigen::Vector3f>& table, const CubeMap& map, int cell) {
  const float scale = static_cast<float>(kTableCells) / static_cast<float>(map.n());
  const float across = scale * (static_cast<float>(cell % map.n()) + 0.5f);
  const float down = scale * (static_cast<float>(cell / map.n() % map.n()) + 0.5f);
  const int face = cell / (map.n() * map.n());
  const int column = std::min(static_cast<int>(across), kTableCells - 1);
  const int row = std::min(static_cast<int>(down), kTableCells - 1);
  const float x = across - static_cast<float>(column), y = down - static_cast<float>(row);
  const Eigen::Vector3f *upper = &table.Corner(face, column, row), *lower = &table.Corner(face, column, row + 1);
  return (1 - y) * (upper[0] + x * (upper[1] - upper[0])) + y * (lower[0] + x * (lower[1] - lower[0]));
}

}  // namespace

Result<SkinColours> MeasureDeviation(const FruitCloud& fruit, const SkinMap& map, const SegmentationOptions& options) {
  const auto lightness_weight = static_cast<float>(options.lightness_weight);
  DRUPE_ASSIGN_OR_RETURN(const SphericalFunction function, FitHealthy(MedianColours(fruit, lightness_weight)));
  const auto healthy = CubeTable<Eigen::Vector3f>::Of(
      kTableCells, [&](const Eigen::Vector3d& d) { return Eigen::Vector3f(function.At(d).cast<float>()); });
  const std::vector<Eigen::Vector4f> sums = CellSums(fruit, map, lightness_weight);
  SkinColours colours;
  colours.deviation.assign(map.size(), Eigen::Vector3f::Zero());
  colours.healthy.assign(map.size(), Eigen::Vector3f::Zero());
  colours.seen.assign(map.size(), 0);
  std::vector<float> sizes;
  for (int cell = 0; cell < map.size(); ++cell) {
    const Eigen::Vector4f sum = Smooth(sums, map, cell);
    if (sum[3] <= 0) continue;
    colours.seen[cell] = 1;
    colours.healthy[cell] = AtCell(healthy, map.map(), cell);
    colours.deviation[cell] = sum.head<3>() / sum[3] - colours.healthy[cell];
    sizes.push_back(colours.deviation[cell].norm());
  }
  colours.sigma = RobustSigma(std::move(sizes));
  return colours;
}

}  // namespace drupe
