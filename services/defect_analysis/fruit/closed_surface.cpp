#include "defect_analysis/fruit/closed_surface.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "geometry/robust.h"
#include "geometry/solve_symmetric.h"
#include "geometry/spherical_harmonics.h"

namespace drupe {
namespace {

constexpr int kTableCells = 64;            // of the surface's table, a side of a face
constexpr double kPointsPerCell = 6;       // wanted in the cells whose medians are fitted
constexpr double kSmoothness = 1e-8;       // see FitSphericalFunction
constexpr double kMirrorWeight = 0.05;     // of a mirrored direction against a seen one
constexpr double kPole = 0.5;              // radians about the seen pole that are not mirrored
constexpr double kMinScaleShare = 0.0008;  // of the radius: scale below which the re-weighting does not go
constexpr std::size_t kSphereSample = 5000;

Status NotAFruit(const char* why) {
  return Unprocessable("not_a_fruit", why);
}

// The cells that were seen, with the median radius of each.
struct SeenCells {
  std::vector<Eigen::Vector3d> directions;
  Eigen::MatrixXd radii;  // one column
  std::vector<int> cells;
};

SeenCells MedianRadii(const std::vector<Eigen::Vector3d>& points, const Eigen::Vector3d& centre, const CubeMap& map) {
  std::vector<std::vector<float>> radii(map.size());
  for (const Eigen::Vector3d& x : points) {
    const Eigen::Vector3f offset = (x - centre).cast<float>();
    radii[map.CellOf(offset)].push_back(offset.norm());
  }
  SeenCells seen;
  for (int cell = 0; cell < map.size(); ++cell) {
    if (!radii[cell].empty()) seen.cells.push_back(cell);
  }
  seen.radii.resize(static_cast<Eigen::Index>(seen.cells.size()), 1);
  for (std::size_t i = 0; i < seen.cells.size(); ++i) {
    seen.directions.push_back(map.DirectionOf(seen.cells[i]));
    seen.radii(static_cast<Eigen::Index>(i), 0) = Median(radii[seen.cells[i]]);
  }
  return seen;
}

Eigen::VectorXd TukeyWeights(const Eigen::VectorXd& residuals, double scale) {
  return residuals.unaryExpr([scale](double r) { return TukeyWeight(r / scale); });
}

// Degrees rise step by step: the coarse shape finds the outliers before the fine one could follow them.
Result<SphericalFunction> FitRobustly(const SeenCells& seen, int degree, double* residual,
                                      Eigen::VectorXd* final_weights) {
  const Eigen::MatrixXd basis = SphericalBasisRows(degree, seen.directions);
  const Eigen::VectorXd target = seen.radii.col(0);
  Eigen::VectorXd weights = Eigen::VectorXd::Ones(target.size());
  const double mean_radius = target.mean();
  weights =
      TukeyWeights(target.array() - Median(std::vector<double>(target.begin(), target.end())), 0.12 * mean_radius);
  SphericalFunction function;
  for (const int step : {2, 2, 2, 4, 4, 8, degree, degree}) {
    const int used = std::min(step, degree);
    DRUPE_ASSIGN_OR_RETURN(function, FitSphericalFunction(used, basis, seen.radii, weights, kSmoothness));
    const Eigen::VectorXd residuals = target - basis.leftCols((used + 1) * (used + 1)) * function.coefficients();
    *residual = RobustSigma(std::vector<double>(residuals.begin(), residuals.end()));
    weights = TukeyWeights(residuals, std::max(*residual, kMinScaleShare * mean_radius));
  }
  *final_weights = weights;
  return function;
}

// How far along `up` the widest level of the seen skin lies from the centre: the top of the parabola through the
// squared distances from the axis, which is exact for an ellipsoid.
double EquatorHeight(const SeenCells& seen, const Eigen::VectorXd& weights, const Eigen::Vector3d& up) {
  Eigen::Matrix3d normal = 1e-9 * Eigen::Matrix3d::Identity();
  Eigen::Vector3d rhs = Eigen::Vector3d::Zero();
  for (Eigen::Index i = 0; i < weights.size(); ++i) {
    const Eigen::Vector3d x = seen.radii(i, 0) * seen.directions[static_cast<std::size_t>(i)];
    const double height = up.dot(x);
    const Eigen::Vector3d row(1, height, height * height);
    normal += weights[i] * row * row.transpose();
    rhs += weights[i] * (x.squaredNorm() - height * height) * row;
  }
  const Eigen::Vector3d parabola = SolveSymmetric(normal, rhs);
  return parabola[2] < 0 ? -parabola[1] / (2 * parabola[2]) : 0;
}

// Fits once more with the unseen directions filled, at a small weight, by the radius on the other side of the equator:
// fruit is nearly symmetric about it, and where nothing was seen that is a better guess than a guess at curvature. Only
// the poles differ: a stalk's hollow or a tip at the one is not at the other, which the flanks are continued over.
Result<SphericalFunction> CloseByMirror(const SeenCells& seen, const Eigen::VectorXd& weights, const CubeMap& map,
                                        const SphericalFunction& open, const Eigen::Vector3d& up, int degree) {
  std::vector<std::uint8_t> is_seen(map.size(), 0);
  for (Eigen::Index i = 0; i < weights.size(); ++i) is_seen[seen.cells[i]] = weights[i] > 0 ? 1 : 0;
  std::vector<Eigen::Vector3d> directions = seen.directions;
  std::vector<double> radii(seen.radii.col(0).begin(), seen.radii.col(0).end());
  std::vector<double> all_weights(weights.begin(), weights.end());
  for (int cell = 0; cell < map.size(); ++cell) {
    const Eigen::Vector3d direction = map.DirectionOf(cell);
    const Eigen::Vector3d mirrored = direction - 2 * up.dot(direction) * up;
    if (is_seen[cell] != 0 || is_seen[map.CellOf(mirrored.cast<float>())] == 0) continue;
    if (up.dot(mirrored) > std::cos(kPole)) continue;
    directions.push_back(direction);
    radii.push_back(open.At(mirrored)[0]);
    all_weights.push_back(kMirrorWeight);
  }
  const auto count = static_cast<Eigen::Index>(radii.size());
  return FitSphericalFunction(degree, SphericalBasisRows(degree, directions),
                              Eigen::MatrixXd(Eigen::Map<Eigen::VectorXd>(radii.data(), count)),
                              Eigen::VectorXd(Eigen::Map<Eigen::VectorXd>(all_weights.data(), count)), kSmoothness);
}

FruitSurface Tabulate(const SphericalFunction& function, const Eigen::Vector3d& centre) {
  const auto radius = [&](const Eigen::Vector3d& direction) { return static_cast<float>(function.At(direction)[0]); };
  return FruitSurface(centre, CubeTable<float>::Of(kTableCells, radius));
}

bool IsClosed(const SphericalFunction& function, const CubeMap& map, double mean_radius) {
  for (int cell = 0; cell < map.size(); cell += 7) {
    const double radius = function.At(map.DirectionOf(cell))[0];
    if (!(radius > 0.2 * mean_radius && radius < 3 * mean_radius)) return false;
  }
  return true;
}

double ObservedShare(const FruitSurface& surface, const SeenCells& seen, const CubeMap& map, double limit) {
  double observed = 0;
  for (std::size_t i = 0; i < seen.cells.size(); ++i) {
    const double radius = seen.radii(static_cast<Eigen::Index>(i), 0);
    if (std::abs(radius - surface.RadiusAt(seen.directions[i].cast<float>())) > limit) continue;
    observed += map.SolidAngle(seen.cells[i]) * surface.AreaPerSolidAngle(seen.directions[i]);
  }
  return std::min(1.0, observed / surface.Area());
}

}  // namespace

Result<Sphere> FitSphere(const std::vector<Eigen::Vector3d>& points) {
  const std::size_t step = std::max<std::size_t>(1, points.size() / kSphereSample);
  std::vector<Eigen::Vector3d> sample;
  for (std::size_t i = 0; i < points.size(); i += step) sample.push_back(points[i]);
  if (sample.size() < 10) return NotAFruit("too few points");
  Sphere sphere;
  std::vector<double> weights(sample.size(), 1.0);
  const Eigen::Vector3d origin = sample.front();  // keeps the squares below small
  for (int iteration = 0; iteration < 12; ++iteration) {
    Eigen::Matrix4d normal = 1e-12 * Eigen::Matrix4d::Identity();
    Eigen::Vector4d rhs = Eigen::Vector4d::Zero();
    for (std::size_t i = 0; i < sample.size(); ++i) {
      const Eigen::Vector3d x = sample[i] - origin;
      const Eigen::Vector4d row(2 * x.x(), 2 * x.y(), 2 * x.z(), 1);
      normal += weights[i] * row * row.transpose();
      rhs += weights[i] * x.squaredNorm() * row;
    }
    const Eigen::Vector4d solution = SolveSymmetric(normal, rhs);
    sphere.centre = solution.head<3>() + origin;
    const double squared = solution[3] + solution.head<3>().squaredNorm();
    if (!(squared > 0) || !std::isfinite(squared)) return NotAFruit("the points lie on no sphere");
    sphere.radius = std::sqrt(squared);
    std::vector<double> residuals(sample.size());
    for (std::size_t i = 0; i < sample.size(); ++i) residuals[i] = (sample[i] - sphere.centre).norm() - sphere.radius;
    const double scale = std::max(RobustSigma(residuals), 0.01 * sphere.radius);
    for (std::size_t i = 0; i < sample.size(); ++i) weights[i] = TukeyWeight(residuals[i] / scale);
  }
  return sphere;
}

Result<ClosedSurface> FitClosedSurface(const std::vector<Eigen::Vector3d>& points, const Eigen::Vector3d& up,
                                       const FruitOptions& options) {
  DRUPE_ASSIGN_OR_RETURN(const Sphere sphere, FitSphere(points));
  const auto wanted = std::sqrt(static_cast<double>(points.size()) / (6 * kPointsPerCell));
  const CubeMap map(std::clamp(static_cast<int>(wanted), 8, 40));
  const int degree = std::min(options.surface_degree, map.n() / 2);
  ClosedSurface result;
  Eigen::Vector3d centre = sphere.centre;
  Eigen::VectorXd weights;
  SeenCells seen;
  SphericalFunction function;
  // The second pass looks from the middle of the equator, about which the underside mirrors the top.
  for (int pass = 0; pass < 2; ++pass) {
    seen = MedianRadii(points, centre, map);
    if (static_cast<int>(seen.cells.size()) < (degree + 1) * (degree + 1))
      return NotAFruit("too few directions are seen");
    DRUPE_ASSIGN_OR_RETURN(function,
                           FitRobustly(seen, pass == 0 ? std::min(4, degree) : degree, &result.residual_mm, &weights));
    if (pass == 0)
      centre += std::clamp(EquatorHeight(seen, weights, up), -0.2 * sphere.radius, 0.2 * sphere.radius) * up;
  }
  DRUPE_ASSIGN_OR_RETURN(function, CloseByMirror(seen, weights, map, function, up, degree));
  if (!IsClosed(function, map, sphere.radius)) return NotAFruit("the points do not surround a centre");
  result.surface = Tabulate(function, centre);
  result.observed_share =
      ObservedShare(result.surface, seen, map, std::max(options.outlier_distance_mm, 4 * result.residual_mm));
  return result;
}

}  // namespace drupe
