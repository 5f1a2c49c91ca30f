#include "reconstruction/features/extrema.h"

#include <Eigen/Core>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <optional>

#include "reconstruction/features/extrema_scan.h"

namespace drupe {
namespace {

/// Extrema nearer to the border than this are left alone: their neighbourhood is made up.
constexpr int kBorder = 5;
/// Steps of whole pixels that the refinement may take before it gives up (Lowe's limit).
constexpr int kMaxSteps = 5;
/// Values next to the row's ends that vector loads may touch.
constexpr int kRowMargin = 16;

/// The difference of Gaussians around one sample, computed from the levels themselves.
struct DogView {
  const Octave& octave;
  int level, x, y;

  double At(int dl, int dx, int dy) const {
    const auto& levels = octave.levels;
    return levels[level + dl + 1].At(x + dx, y + dy) - levels[level + dl].At(x + dx, y + dy);
  }
  /// Half the difference along (x, y, level), and the Hessian.
  Eigen::Vector3d Gradient() const {
    return 0.5 * Eigen::Vector3d(At(0, 1, 0) - At(0, -1, 0), At(0, 0, 1) - At(0, 0, -1), At(1, 0, 0) - At(-1, 0, 0));
  }
  Eigen::Matrix3d Hessian() const {
    const double twice = 2 * At(0, 0, 0);
    const double xx = At(0, 1, 0) + At(0, -1, 0) - twice;
    const double yy = At(0, 0, 1) + At(0, 0, -1) - twice;
    const double ss = At(1, 0, 0) + At(-1, 0, 0) - twice;
    const double xy = 0.25 * (At(0, 1, 1) - At(0, -1, 1) - At(0, 1, -1) + At(0, -1, -1));
    const double xs = 0.25 * (At(1, 1, 0) - At(1, -1, 0) - At(-1, 1, 0) + At(-1, -1, 0));
    const double ys = 0.25 * (At(1, 0, 1) - At(1, 0, -1) - At(-1, 0, 1) + At(-1, 0, -1));
    Eigen::Matrix3d hessian;
    hessian << xx, xy, xs, xy, yy, ys, xs, ys, ss;
    return hessian;
  }
};

bool IsInside(const Octave& octave, int scales, int level, int x, int y) {
  return level >= 1 && level <= scales && x >= kBorder && x < octave.width() - kBorder && y >= kBorder &&
         y < octave.height() - kBorder;
}

/// Lowe's test of section 4.1: the ratio of the principal curvatures is below `edge_threshold`.
bool IsCorner(const Eigen::Matrix3d& hessian, double edge_threshold) {
  const double trace = hessian(0, 0) + hessian(1, 1);
  const double determinant = hessian(0, 0) * hessian(1, 1) - hessian(0, 1) * hessian(0, 1);
  return determinant > 0 && trace * trace * edge_threshold < (edge_threshold + 1) * (edge_threshold + 1) * determinant;
}

}  // namespace

ExtremaFinder::ExtremaFinder(const FeatureOptions& options, const GrayImage* mask) : options_(options), mask_(mask) {}

void ExtremaFinder::Begin(const Octave& octave, int octave_index) {
  octave_index_ = octave_index;
  next_row_ = 0;
  dog_ = FloatImage(octave.width() + kRowMargin, 3 * (options_.scales_per_octave + 2));
}

void ExtremaFinder::OnRows(const Octave& octave, int octave_index, int finished_rows) {
  if (octave_index != octave_index_) Begin(octave, octave_index);
  finished_rows_ = finished_rows;
  for (; next_row_ < finished_rows; ++next_row_) {
    for (int d = 0; d < options_.scales_per_octave + 2; ++d) {
      SubtractRows(octave.levels[d + 1].Row(next_row_), octave.levels[d].Row(next_row_), octave.width(),
                   DogRow(d, next_row_));
    }
    const int y = next_row_ - 1;
    if (y >= kBorder && y < octave.height() - kBorder) ScanRow(octave, y);
  }
}

void ExtremaFinder::ScanRow(const Octave& octave, int y) {
  // Half the threshold: the refined value is larger than the sample's.
  const auto threshold = static_cast<float>(0.5 * 255 * options_.peak_threshold / options_.scales_per_octave);
  for (int d = 1; d <= options_.scales_per_octave; ++d) {
    DogNeighbourhood rows;
    for (int s = 0; s < 3; ++s) {
      for (int r = 0; r < 3; ++r) rows[s][r] = DogRow(d - 1 + s, y - 1 + r);
    }
    columns_.clear();
    FindExtremaInRow(rows, kBorder, octave.width() - kBorder, threshold, columns_);
    for (const int x : columns_) Refine(octave, d, x, y);
  }
}

void ExtremaFinder::Refine(const Octave& octave, int level, int x, int y) {
  for (int step = 0; step < kMaxSteps; ++step) {
    if (!IsInside(octave, options_.scales_per_octave, level, x, y) || y + 1 >= finished_rows_) return;
    const DogView view{octave, level, x, y};
    const Eigen::Vector3d gradient = view.Gradient();
    const Eigen::Matrix3d hessian = view.Hessian();
    const Eigen::Vector3d offset = -hessian.partialPivLu().solve(gradient);
    if (!offset.allFinite() || offset.cwiseAbs().maxCoeff() > 3) return;
    if (offset.cwiseAbs().maxCoeff() > 0.6) {
      x += static_cast<int>(std::lround(offset.x()));
      y += static_cast<int>(std::lround(offset.y()));
      level += static_cast<int>(std::lround(offset.z()));
      continue;
    }
    const double value = std::abs(view.At(0, 0, 0) + 0.5 * gradient.dot(offset)) / 255;
    if (value * options_.scales_per_octave < options_.peak_threshold) return;
    if (!IsCorner(hessian, options_.edge_threshold)) return;
    Extremum e{octave_index_,
               level,
               static_cast<float>(x + offset.x()),
               static_cast<float>(y + offset.y()),
               0,
               static_cast<float>(value)};
    const double scale = (level + offset.z()) / options_.scales_per_octave;
    e.sigma = static_cast<float>(options_.base_sigma * std::exp2(scale));
    if (!IsMasked(octave, e.x, e.y)) extrema_.push_back(e);
    return;
  }
}

bool ExtremaFinder::IsMasked(const Octave& octave, float x, float y) const {
  if (mask_ == nullptr) return false;
  const int column = std::clamp(static_cast<int>(std::lround(x * octave.pixel_step)), 0, mask_->width() - 1);
  const int row = std::clamp(static_cast<int>(std::lround(y * octave.pixel_step)), 0, mask_->height() - 1);
  return mask_->At(column, row) == 0;
}

}  // namespace drupe
