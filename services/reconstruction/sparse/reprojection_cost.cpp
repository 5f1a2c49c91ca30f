#include "reconstruction/sparse/reprojection_cost.h"

#include <ceres/sized_cost_function.h>

#include <Eigen/Geometry>

namespace drupe {
namespace {

using PoseJacobian = Eigen::Matrix<double, 2, kPoseSize, Eigen::RowMajor>;
using PointJacobian = Eigen::Matrix<double, 2, 3, Eigen::RowMajor>;

constexpr double kMinDepthShare = 1e-6;  // of the distance: closer to the camera's plane a projection means nothing

/// A point seen from a pose block.
struct Transformed {
  explicit Transformed(const double* pose, const Eigen::Vector3d& point)
      : v(pose[0], pose[1], pose[2]), w(pose[3]), x(point) {
    const Eigen::Vector3d cross = v.cross(x);
    in_cam = x + 2 * (w * cross + v.cross(cross)) + Eigen::Vector3d(pose[4], pose[5], pose[6]);
  }
  bool IsInFront() const { return in_cam.z() > kMinDepthShare * in_cam.norm(); }
  Eigen::Vector2d Projected() const { return in_cam.head<2>() / in_cam.z(); }

  /// d(projected)/d(in_cam)
  PointJacobian ByCamera() const {
    const double iz = 1 / in_cam.z();
    PointJacobian jacobian;
    jacobian << iz, 0, -in_cam.x() * iz * iz, 0, iz, -in_cam.y() * iz * iz;
    return jacobian;
  }

  /// d(in_cam)/d(x, y, z, w, translation) of x + 2 w (v cross x) + 2 v (v.x) - 2 (v.v) x, which is the rotation on unit
  /// quaternions; the manifold keeps them unit.
  Eigen::Matrix<double, 3, kPoseSize> ByPose() const {
    Eigen::Matrix<double, 3, kPoseSize> jacobian;
    Eigen::Matrix3d by_v = 2 * v * x.transpose() - 4 * x * v.transpose();
    by_v.diagonal().array() += 2 * v.dot(x);
    by_v(0, 1) += 2 * w * x.z(), by_v(0, 2) -= 2 * w * x.y();
    by_v(1, 0) -= 2 * w * x.z(), by_v(1, 2) += 2 * w * x.x();
    by_v(2, 0) += 2 * w * x.y(), by_v(2, 1) -= 2 * w * x.x();
    jacobian.leftCols<3>() = by_v;
    jacobian.col(3) = 2 * v.cross(x);
    jacobian.rightCols<3>().setIdentity();
    return jacobian;
  }

  Eigen::Matrix3d Rotation() const { return Eigen::Quaterniond(w, v.x(), v.y(), v.z()).toRotationMatrix(); }

  Eigen::Vector3d v;
  double w;
  Eigen::Vector3d x;
  Eigen::Vector3d in_cam;
};

class ReprojectionCost final : public ceres::SizedCostFunction<2, kPoseSize, 3> {
 public:
  ReprojectionCost(const ImageMeasurement& measured, double sigma_px)
      : xy_(measured.xy), whitened_pixel_from_normalised_(measured.pixel_from_normalised / sigma_px) {}
  bool Evaluate(double const* const* parameters, double* residuals, double** jacobians) const override;

 private:
  Eigen::Vector2d xy_;
  Eigen::Matrix2d whitened_pixel_from_normalised_;
};

class BoardCornerCost final : public ceres::SizedCostFunction<2, kPoseSize, 1> {
 public:
  BoardCornerCost(const BoardCorner& corner, double sigma_px)
      : planned_(corner.planned),
        outward_(corner.outward),
        xy_(corner.measured.xy),
        whitened_pixel_from_normalised_(corner.measured.pixel_from_normalised / sigma_px) {}
  bool Evaluate(double const* const* parameters, double* residuals, double** jacobians) const override;

 private:
  Eigen::Vector3d planned_, outward_;
  Eigen::Vector2d xy_;
  Eigen::Matrix2d whitened_pixel_from_normalised_;
};

class RefinedCameraCost final : public ceres::SizedCostFunction<2, kPoseSize, 3, kIntrinsicsSize> {
 public:
  RefinedCameraCost(const PinholeCamera& camera, const Eigen::Vector2d& pixel, double sigma_px)
      : camera_(camera), pixel_(pixel), whitening_(1 / sigma_px) {}
  bool Evaluate(double const* const* parameters, double* residuals, double** jacobians) const override;

 private:
  const PinholeCamera& camera_;
  Eigen::Vector2d pixel_;
  double whitening_;
};

bool ReprojectionCost::Evaluate(double const* const* parameters, double* residuals, double** jacobians) const {
  const Transformed point(parameters[0], Eigen::Map<const Eigen::Vector3d>(parameters[1]));
  if (!point.IsInFront()) return false;
  Eigen::Map<Eigen::Vector2d> residual(residuals);
  residual = whitened_pixel_from_normalised_ * (point.Projected() - xy_);
  if (jacobians == nullptr) return true;
  const PointJacobian by_camera = whitened_pixel_from_normalised_ * point.ByCamera();
  if (jacobians[0] != nullptr) Eigen::Map<PoseJacobian>(jacobians[0]).noalias() = by_camera * point.ByPose();
  if (jacobians[1] != nullptr) Eigen::Map<PointJacobian>(jacobians[1]).noalias() = by_camera * point.Rotation();
  return true;
}

bool BoardCornerCost::Evaluate(double const* const* parameters, double* residuals, double** jacobians) const {
  const Transformed point(parameters[0], planned_ + parameters[1][0] * outward_);
  if (!point.IsInFront()) return false;
  Eigen::Map<Eigen::Vector2d> residual(residuals);
  residual = whitened_pixel_from_normalised_ * (point.Projected() - xy_);
  if (jacobians == nullptr) return true;
  const PointJacobian by_camera = whitened_pixel_from_normalised_ * point.ByCamera();
  if (jacobians[0] != nullptr) Eigen::Map<PoseJacobian>(jacobians[0]).noalias() = by_camera * point.ByPose();
  if (jacobians[1] != nullptr) {
    Eigen::Map<Eigen::Vector2d> jacobian(jacobians[1]);
    jacobian = by_camera * (point.Rotation() * outward_);
  }
  return true;
}

bool RefinedCameraCost::Evaluate(double const* const* parameters, double* residuals, double** jacobians) const {
  const Transformed point(parameters[0], Eigen::Map<const Eigen::Vector3d>(parameters[1]));
  if (!point.IsInFront()) return false;
  PinholeCamera camera = camera_;
  camera.fx *= parameters[2][0], camera.fy *= parameters[2][0];
  camera.dist[0] = parameters[2][1], camera.dist[1] = parameters[2][2];
  const Eigen::Vector2d xy = point.Projected();
  Eigen::Matrix2d by_xy;
  const Eigen::Vector2d projected = camera.PixelFromNormalised(xy, &by_xy);
  Eigen::Map<Eigen::Vector2d> residual(residuals);
  residual = whitening_ * (projected - pixel_);
  if (jacobians == nullptr) return true;
  const PointJacobian by_camera = whitening_ * by_xy * point.ByCamera();
  if (jacobians[0] != nullptr) Eigen::Map<PoseJacobian>(jacobians[0]).noalias() = by_camera * point.ByPose();
  if (jacobians[1] != nullptr) Eigen::Map<PointJacobian>(jacobians[1]).noalias() = by_camera * point.Rotation();
  if (jacobians[2] != nullptr) {
    const double r2 = xy.squaredNorm();
    const Eigen::Vector2d in_pixels(camera.fx * xy.x(), camera.fy * xy.y());
    Eigen::Map<Eigen::Matrix<double, 2, kIntrinsicsSize, Eigen::RowMajor>> jacobian(jacobians[2]);
    jacobian.col(0) = whitening_ * (projected - Eigen::Vector2d(camera.cx, camera.cy)) / parameters[2][0];
    jacobian.col(1) = whitening_ * r2 * in_pixels;
    jacobian.col(2) = whitening_ * r2 * r2 * in_pixels;
  }
  return true;
}

}  // namespace

std::unique_ptr<ceres::CostFunction> MakeReprojectionCost(const ImageMeasurement& measured, double sigma_px) {
  return std::make_unique<ReprojectionCost>(measured, sigma_px);
}

std::unique_ptr<ceres::CostFunction> MakeBoardCornerCost(const BoardCorner& corner, double sigma_px) {
  return std::make_unique<BoardCornerCost>(corner, sigma_px);
}

std::unique_ptr<ceres::CostFunction> MakeRefinedCameraCost(const PinholeCamera& camera, const Eigen::Vector2d& pixel,
                                                           double sigma_px) {
  return std::make_unique<RefinedCameraCost>(camera, pixel, sigma_px);
}

}  // namespace drupe
