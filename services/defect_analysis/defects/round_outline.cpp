#include "defect_analysis/defects/round_outline.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "geometry/robust.h"

namespace drupe {
namespace {

using std::numbers::pi;
constexpr int kTurnBins = 180;
constexpr double kLeastTurn = 0.4;
constexpr int kFitIterations = 12;
constexpr double kLeastScale = 0.012;  // of the radius: below it no point is an outlier by its distance in scales
constexpr int kRepairWaves = 5;
constexpr double kRepairRidge = 1e-4;  // of a wave, by its number squared
constexpr double kMostScale = 0.03;    // of the radius: the outline has no form beyond
constexpr double kMostOutliers = 0.3;  // of the turn
constexpr double kOutlier = 0.06;      // of the radius, and
constexpr double kOutlierScales = 3;   // this many scales from the form
constexpr int kFlank = 2;              // bins beside an outlier that it may have bent

double AngleOf(const Eigen::Vector2d& offset) {
  return std::atan2(offset.y(), offset.x());
}

int BinOf(double angle) {
  return static_cast<int>(std::floor((angle / (2 * pi) + 1) * kTurnBins)) % kTurnBins;
}

// The distance from a middle as a function of the turn: a mean and some waves.
class RadialForm {
 public:
  RadialForm(const Eigen::Vector2d& middle, int waves)
      : middle_(middle), waves_(Eigen::VectorXd::Zero(2 * waves + 1)) {}

  // Weighted least squares; `ridge` of wave k draws it to 0, in units of the points' number.
  template <typename Ridge>
  void Fit(const std::vector<Eigen::Vector2d>& points, const std::vector<double>& weights, const Ridge& ridge) {
    Eigen::MatrixXd normal = Eigen::MatrixXd::Zero(waves_.size(), waves_.size());
    Eigen::VectorXd rhs = Eigen::VectorXd::Zero(waves_.size());
    for (std::size_t i = 0; i < points.size(); ++i) {
      const Eigen::VectorXd row = RowAt(AngleOf(points[i] - middle_));
      normal += weights[i] * row * row.transpose();
      rhs += weights[i] * (points[i] - middle_).norm() * row;
    }
    for (int k = 1; 2 * k < waves_.size(); ++k) {
      const double stiffness = (1e-6 + ridge(k)) * static_cast<double>(points.size());
      normal(2 * k - 1, 2 * k - 1) += stiffness;
      normal(2 * k, 2 * k) += stiffness;
    }
    waves_ = normal.ldlt().solve(rhs);
  }

  double RadiusAt(double angle) const { return RowAt(angle).dot(waves_); }
  double mean_radius() const { return waves_[0]; }
  double WaveSize(int k) const { return waves_.segment<2>(2 * k - 1).norm(); }
  const Eigen::Vector2d& middle() const { return middle_; }
  // Moves the middle to where the first wave vanishes, to first order.
  void Recentre() {
    middle_ += waves_.segment<2>(1);
    waves_.segment<2>(1).setZero();
  }

  std::vector<double> Residuals(const std::vector<Eigen::Vector2d>& points) const {
    std::vector<double> residuals;
    for (const Eigen::Vector2d& p : points) {
      residuals.push_back((p - middle_).norm() - RadiusAt(AngleOf(p - middle_)));
    }
    return residuals;
  }

  // The points' radii against the form in each bin of the turn; 1 where none is used.
  std::array<double, kTurnBins> Ratios(const std::vector<Eigen::Vector2d>& points,
                                       const std::vector<std::uint8_t>& used) const {
    std::array<double, kTurnBins> sums{}, counts{}, ratios{};
    for (std::size_t i = 0; i < points.size(); ++i) {
      if (used[i] == 0) continue;
      const double angle = AngleOf(points[i] - middle_);
      const auto bin = static_cast<std::size_t>(BinOf(angle));
      sums[bin] += (points[i] - middle_).norm() / RadiusAt(angle);
      counts[bin] += 1;
    }
    for (std::size_t k = 0; k < kTurnBins; ++k) ratios[k] = counts[k] > 0 ? sums[k] / counts[k] : 1;
    return ratios;
  }

  Polygon Draw(const std::array<double, kTurnBins>& ratios) const {
    Polygon polygon;
    for (int k = 0; k < kTurnBins; ++k) {
      const double angle = 2 * pi * (k + 0.5) / kTurnBins;
      const double radius = ratios[static_cast<std::size_t>(k)] * RadiusAt(angle);
      polygon.push_back(middle_ + radius * Eigen::Vector2d(std::cos(angle), std::sin(angle)));
    }
    return polygon;
  }

 private:
  Eigen::VectorXd RowAt(double angle) const {
    Eigen::VectorXd row(waves_.size());
    row[0] = 1;
    for (int k = 1; 2 * k < row.size(); ++k) {
      row[2 * k - 1] = std::cos(k * angle);
      row[2 * k] = std::sin(k * angle);
    }
    return row;
  }

  Eigen::Vector2d middle_;
  Eigen::VectorXd waves_;  // mean, then cosine and sine of each wave
};

// Robust standard deviation of the residuals, at least what a smooth outline of real colours leaves.
double ScaleOf(const std::vector<double>& residuals, double radius) {
  return std::max(kLeastScale * radius, RobustSigma(residuals));
}

std::vector<double> Weights(const std::vector<double>& residuals, double scale) {
  std::vector<double> weights;
  for (const double residual : residuals) weights.push_back(TukeyWeight(residual / scale));
  return weights;
}

// The turn that each point stands for, 1 on average: the sides of a horn have many points but little turn.
std::vector<double> TurnWeights(const Polygon& outline, const Eigen::Vector2d& middle) {
  const std::size_t count = outline.size();
  std::vector<double> turns;
  for (std::size_t i = 0; i < count; ++i) {
    const Eigen::Vector2d before = outline[(i + count - 1) % count] - middle, after = outline[(i + 1) % count] - middle;
    const double turn = std::abs(std::remainder(AngleOf(after) - AngleOf(before), 2 * pi));
    turns.push_back(turn / (4 * pi) * static_cast<double>(count));
  }
  return turns;
}

double SeenShare(const std::vector<Eigen::Vector2d>& seen, const Eigen::Vector2d& middle) {
  std::array<bool, kTurnBins> bins{};
  for (const Eigen::Vector2d& p : seen) {
    // A bin's neighbours count too: a small outline has fewer points than bins.
    const int bin = BinOf(AngleOf(p - middle));
    for (const int near : {bin + kTurnBins - 1, bin, bin + 1}) bins[static_cast<std::size_t>(near % kTurnBins)] = true;
  }
  return static_cast<double>(std::count(bins.begin(), bins.end(), true)) / kTurnBins;
}

// Which points lie off the form, or share a bin of the turn with such a one or with its flanks.
std::vector<std::uint8_t> Agreeing(const RadialForm& form, const std::vector<Eigen::Vector2d>& points,
                                   const std::vector<double>& residuals, double limit, double* outlier_share) {
  std::array<bool, kTurnBins> off{};
  for (std::size_t i = 0; i < points.size(); ++i) {
    if (std::abs(residuals[i]) <= limit) continue;
    const int bin = BinOf(AngleOf(points[i] - form.middle()));
    for (int near = bin - kFlank; near <= bin + kFlank; ++near) {
      off[static_cast<std::size_t>((near + kTurnBins) % kTurnBins)] = true;
    }
  }
  std::vector<std::uint8_t> agreeing;
  for (const Eigen::Vector2d& p : points) {
    agreeing.push_back(off[static_cast<std::size_t>(BinOf(AngleOf(p - form.middle())))] ? 0 : 1);
  }
  *outlier_share = static_cast<double>(std::count(off.begin(), off.end(), true)) / kTurnBins;
  return agreeing;
}

}  // namespace

std::optional<CompletedOutline> CompleteOutline(const std::vector<Eigen::Vector2d>& seen) {
  if (seen.size() < 12) return std::nullopt;
  Eigen::Vector2d middle = Eigen::Vector2d::Zero();
  for (const Eigen::Vector2d& p : seen) middle += p / static_cast<double>(seen.size());
  RadialForm form(middle, 2);
  std::vector<double> weights(seen.size(), 1), residuals;
  double share = 0;
  for (int iteration = 0; iteration < kFitIterations; ++iteration) {
    share = SeenShare(seen, form.middle());
    form.Fit(seen, weights, [share](int k) { return k == 2 ? 0.5 * (1 - share) * (1 - share) : 0; });
    if (!(form.mean_radius() > 0) || form.WaveSize(1) > 2 * form.mean_radius()) return std::nullopt;
    form.Recentre();
    residuals = form.Residuals(seen);
    // The middle must have settled before a point can be called an outlier.
    if (iteration >= kFitIterations / 2) weights = Weights(residuals, ScaleOf(residuals, form.mean_radius()));
  }
  if (share < kLeastTurn || form.WaveSize(2) > 0.5 * form.mean_radius()) return std::nullopt;
  CompletedOutline result{.polygon = {}, .rms = 0, .seen_share = share};
  for (const double error : residuals) result.rms += error * error / static_cast<double>(seen.size());
  result.rms = std::sqrt(result.rms) / form.mean_radius();
  std::vector<std::uint8_t> used;
  for (const double weight : weights) used.push_back(weight > 0 ? 1 : 0);
  result.polygon = form.Draw(form.Ratios(seen, used));
  return result;
}

std::optional<Polygon> RepairRoundOutline(const Polygon& outline) {
  if (outline.size() < 4 * kRepairWaves) return std::nullopt;
  RadialForm form(Centroid(outline), kRepairWaves);
  const std::vector<double> turns = TurnWeights(outline, form.middle());
  std::vector<double> residuals, radii;
  for (const Eigen::Vector2d& p : outline) radii.push_back((p - form.middle()).norm());
  const double radius = Median(radii);
  for (double r : radii) residuals.push_back(r - radius);
  for (int iteration = 0; iteration < kFitIterations; ++iteration) {
    std::vector<double> weights = Weights(residuals, ScaleOf(residuals, radius));
    for (std::size_t i = 0; i < weights.size(); ++i) weights[i] *= turns[i];
    form.Fit(outline, weights, [](int k) { return kRepairRidge * k * k; });
    residuals = form.Residuals(outline);
  }
  const double scale = ScaleOf(residuals, radius);
  if (scale > kMostScale * radius) return std::nullopt;
  double outliers = 0;
  const double limit = std::max(kOutlier * radius, kOutlierScales * scale);
  const std::vector<std::uint8_t> agreeing = Agreeing(form, outline, residuals, limit, &outliers);
  if (outliers == 0 || outliers > kMostOutliers) return std::nullopt;
  return form.Draw(form.Ratios(outline, agreeing));
}

}  // namespace drupe
