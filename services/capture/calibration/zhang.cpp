#include "capture/calibration/zhang.h"

#include <cmath>
#include <opencv2/calib3d.hpp>

namespace drupe {
namespace {

constexpr double kSignificantSigmas = 3;

/// The input and output of cv::calibrateCamera.
struct Problem {
  std::vector<std::vector<cv::Point3f>> points_mm;
  std::vector<std::vector<cv::Point2f>> pixels;
  cv::Size size;
};

struct Fit {
  cv::Mat k = cv::Mat::eye(3, 3, CV_64F);
  cv::Mat dist = cv::Mat::zeros(5, 1, CV_64F);
  std::vector<cv::Mat> rotations, translations;
  cv::Mat sigma, extrinsic_sigma, view_rms;
  double rms = 0;
};

Problem MakeProblem(const std::vector<PatternCorners>& views, const Checkerboard& pattern, int width, int height) {
  Problem problem;
  problem.size = cv::Size(width, height);
  for (const PatternCorners& view : views) {
    auto& points = problem.points_mm.emplace_back();
    auto& pixels = problem.pixels.emplace_back();
    for (std::size_t i = 0; i < view.size(); ++i) {
      const Eigen::Vector2d mm = pattern.CornerMm(view.indices[i]);
      points.emplace_back(static_cast<float>(mm.x()), static_cast<float>(mm.y()), 0.0F);
      pixels.emplace_back(static_cast<float>(view.pixels[i].x()), static_cast<float>(view.pixels[i].y()));
    }
  }
  return problem;
}

Fit Calibrate(const Problem& problem, int flags) {
  Fit fit;
  const cv::TermCriteria criteria(cv::TermCriteria::EPS | cv::TermCriteria::COUNT, 200, 1e-12);
  fit.rms = cv::calibrateCamera(problem.points_mm, problem.pixels, problem.size, fit.k, fit.dist, fit.rotations,
                                fit.translations, fit.sigma, fit.extrinsic_sigma, fit.view_rms, flags, criteria);
  return fit;
}

/// Drops the parameters that are not significant, one after the other.
Fit CalibrateSignificant(const Problem& problem, int& flags) {
  flags = 0;
  Fit fit = Calibrate(problem, flags);
  if (std::abs(fit.dist.at<double>(4)) < kSignificantSigmas * fit.sigma.at<double>(8)) {
    flags |= cv::CALIB_FIX_K3;
    fit = Calibrate(problem, flags);
  }
  const double difference = fit.k.at<double>(0, 0) - fit.k.at<double>(1, 1);
  // fx and fy err together, so the sigma of their difference is at most that of one of them.
  if (std::abs(difference) < kSignificantSigmas * fit.sigma.at<double>(0)) {
    flags |= cv::CALIB_FIX_ASPECT_RATIO;  // at the ratio of the identity that each fit starts from
    fit = Calibrate(problem, flags);
  }
  return fit;
}

/// `value` to a thousandth of the power of ten below `scale`. The last digits of cv::calibrateCamera change from call
/// to call for the same input (seen on small pictures, also on one thread), by up to 1e-7 of a parameter's uncertainty;
/// a result must not.
double RoundedTo(double value, double scale) {
  if (!(scale > 0) || !std::isfinite(scale) || !std::isfinite(value)) return value;
  const double unit = std::pow(10.0, std::floor(std::log10(scale)) - 3);
  return std::round(value / unit) * unit;
}

/// To four significant digits.
double Rounded(double value) {
  return RoundedTo(value, std::abs(value));
}

PinholeCamera CameraOf(const Fit& fit, const cv::Size& size, const IntrinsicsSigma& sigma) {
  PinholeCamera camera{.width = size.width, .height = size.height};
  camera.fx = RoundedTo(fit.k.at<double>(0, 0), sigma.fx), camera.fy = RoundedTo(fit.k.at<double>(1, 1), sigma.fy);
  camera.cx = RoundedTo(fit.k.at<double>(0, 2), sigma.cx), camera.cy = RoundedTo(fit.k.at<double>(1, 2), sigma.cy);
  for (int i = 0; i < 5; ++i) camera.dist[i] = RoundedTo(fit.dist.at<double>(i), sigma.dist[i]);
  return camera;
}

/// Before 4.7, OpenCV divided the squared residuals by the count of points, not of coordinates, less the parameters.
double SigmaCorrection(const Problem& problem, int flags) {
  if (CV_VERSION_MAJOR > 4 || (CV_VERSION_MAJOR == 4 && CV_VERSION_MINOR >= 7)) return 1;
  double points = 0;
  for (const auto& view : problem.pixels) points += static_cast<double>(view.size());
  const int fixed = ((flags & cv::CALIB_FIX_K3) != 0) + ((flags & cv::CALIB_FIX_ASPECT_RATIO) != 0);
  const double parameters = 9.0 - fixed + 6.0 * static_cast<double>(problem.pixels.size());
  return points > parameters ? std::sqrt((points - parameters) / (2 * points - parameters)) : 1;
}

IntrinsicsSigma SigmaOf(const Fit& fit, int flags, double correction) {
  const auto value = [&](int i) { return Rounded(fit.sigma.at<double>(i) * correction); };
  IntrinsicsSigma sigma{value(0), value(1), value(2), value(3), {}};
  for (int i = 0; i < 5; ++i) sigma.dist[i] = value(4 + i);
  if (flags & cv::CALIB_FIX_ASPECT_RATIO) sigma.fx = sigma.fy;
  return sigma;
}

Rigid3 PoseOf(const cv::Mat& rotation_vector, const cv::Mat& translation) {
  cv::Mat rotation;
  cv::Rodrigues(rotation_vector, rotation);
  Rigid3 pose;
  for (int row = 0; row < 3; ++row) {
    for (int column = 0; column < 3; ++column) pose.rotation(row, column) = rotation.at<double>(row, column);
    pose.translation[row] = translation.at<double>(row);
  }
  return pose;
}

ZhangSolution SolutionOf(const Fit& fit, int flags, const Problem& problem) {
  ZhangSolution solution;
  solution.sigma = SigmaOf(fit, flags, SigmaCorrection(problem, flags));
  solution.camera = CameraOf(fit, problem.size, solution.sigma);
  solution.rms_px = Rounded(fit.rms);
  solution.fixed_k3 = (flags & cv::CALIB_FIX_K3) != 0;
  solution.square_pixels = (flags & cv::CALIB_FIX_ASPECT_RATIO) != 0;
  for (std::size_t i = 0; i < fit.rotations.size(); ++i) {
    solution.cam_from_pattern.push_back(PoseOf(fit.rotations[i], fit.translations[i]));
    solution.view_rms_px.push_back(Rounded(fit.view_rms.at<double>(static_cast<int>(i))));
  }
  return solution;
}

}  // namespace

Result<ZhangSolution> SolveZhang(const std::vector<PatternCorners>& views, const Checkerboard& pattern, int width,
                                 int height) {
  const Status failed = Unprocessable("calibration_failed",
                                      "the pictures do not determine the camera; take pictures "
                                      "with the pattern tilted in different directions");
  try {
    const Problem problem = MakeProblem(views, pattern, width, height);
    int flags = 0;
    const Fit fit = CalibrateSignificant(problem, flags);
    if (!std::isfinite(fit.rms) || !cv::checkRange(fit.k) || !cv::checkRange(fit.dist)) return failed;
    return SolutionOf(fit, flags, problem);
  } catch (const std::exception&) {
    return failed;
  }
}

}  // namespace drupe
