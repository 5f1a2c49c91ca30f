#include "reconstruction/sparse/reprojection_cost.h"

#include <ceres/cost_function.h>
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <vector>

namespace drupe {
namespace {

PinholeCamera TestCamera() {
  PinholeCamera camera;
  camera.width = 1280, camera.height = 720;
  camera.fx = 1800, camera.fy = 1810, camera.cx = 633, camera.cy = 361;
  camera.dist = {-0.06, 0.01, 0.0002, -0.0001, 0};
  return camera;
}

std::vector<double> TestPose() {
  const Eigen::Quaterniond q(Eigen::AngleAxisd(0.8, Eigen::Vector3d(1, -2, 0.5).normalized()));
  return {q.x(), q.y(), q.z(), q.w(), 4, -7, 210};
}

ImageMeasurement MeasurementNear(const Eigen::Vector2d& pixel) {
  ImageMeasurement measured;
  measured.pixel = pixel;
  measured.xy = TestCamera().NormalisedFromPixel(pixel);
  TestCamera().PixelFromNormalised(measured.xy, &measured.pixel_from_normalised);
  return measured;
}

/// Compares every analytic derivative with central differences. The pose's quaternion leaves the unit sphere by a step,
/// where the cost is defined by the same polynomial.
void CheckDerivatives(const ceres::CostFunction& cost, std::vector<std::vector<double>> blocks) {
  std::vector<double*> parameters;
  for (auto& block : blocks) parameters.push_back(block.data());
  std::vector<std::vector<double>> jacobians;
  std::vector<double*> jacobian_pointers;
  for (const auto& block : blocks) jacobians.emplace_back(2 * block.size());
  for (auto& jacobian : jacobians) jacobian_pointers.push_back(jacobian.data());
  double residual[2], plus[2], minus[2];
  ASSERT_TRUE(cost.Evaluate(parameters.data(), residual, jacobian_pointers.data()));
  for (std::size_t b = 0; b < blocks.size(); ++b) {
    for (std::size_t i = 0; i < blocks[b].size(); ++i) {
      const double kept = blocks[b][i], step = 1e-6 * std::max(1.0, std::abs(kept));
      blocks[b][i] = kept + step;
      ASSERT_TRUE(cost.Evaluate(parameters.data(), plus, nullptr));
      blocks[b][i] = kept - step;
      ASSERT_TRUE(cost.Evaluate(parameters.data(), minus, nullptr));
      blocks[b][i] = kept;
      for (int k = 0; k < 2; ++k) {
        const double numeric = (plus[k] - minus[k]) / (2 * step);
        EXPECT_NEAR(jacobians[b][k * blocks[b].size() + i], numeric, 1e-4 * (1 + std::abs(numeric)))
            << "block " << b << " parameter " << i;
      }
    }
  }
}

TEST(ReprojectionCostTest, DerivativesMatchDifferences) {
  CheckDerivatives(*MakeReprojectionCost(MeasurementNear({700, 300}), 0.5), {TestPose(), {8, -3, 12}});
}

TEST(ReprojectionCostTest, BoardDerivativesMatchDifferences) {
  const BoardCorner corner{{8, -3, 0}, {1, -1, 0}, MeasurementNear({700, 300})};
  CheckDerivatives(*MakeBoardCornerCost(corner, 0.1), {TestPose(), {0.02}});
}

TEST(ReprojectionCostTest, RefinedCameraDerivativesMatchDifferences) {
  const PinholeCamera camera = TestCamera();
  CheckDerivatives(*MakeRefinedCameraCost(camera, {700, 300}, 0.5), {TestPose(), {8, -3, 12}, {1.01, -0.05, 0.02}});
}

TEST(ReprojectionCostTest, LinearisedLensAgreesWithTheLens) {
  const std::vector<double> pose = TestPose();
  const Eigen::Vector3d point(8, -3, 12);
  const Eigen::Quaterniond q(pose[3], pose[0], pose[1], pose[2]);
  const Eigen::Vector2d projected = *TestCamera().Project(q * point + Eigen::Vector3d(pose[4], pose[5], pose[6]));
  const Eigen::Vector2d offset(2, -3);
  const auto cost = MakeReprojectionCost(MeasurementNear(projected + offset), 1.0);
  const double* parameters[] = {pose.data(), point.data()};
  double residual[2];
  ASSERT_TRUE(cost->Evaluate(parameters, residual, nullptr));
  EXPECT_NEAR(residual[0], -offset.x(), 1e-3);
  EXPECT_NEAR(residual[1], -offset.y(), 1e-3);
}

TEST(ReprojectionCostTest, PointBehindTheCameraIsRefused) {
  const auto cost = MakeReprojectionCost(MeasurementNear({700, 300}), 1.0);
  const std::vector<double> pose = {0, 0, 0, 1, 0, 0, 0};
  const Eigen::Vector3d behind(0, 0, -5);
  const double* parameters[] = {pose.data(), behind.data()};
  double residual[2];
  EXPECT_FALSE(cost->Evaluate(parameters, residual, nullptr));
}

}  // namespace
}  // namespace drupe
