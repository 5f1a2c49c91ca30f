#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <vector>

#include "geometry/pinhole_camera.h"
#include "geometry/rigid3.h"
#include "geometry/sim3.h"

namespace drupe {
namespace {

PinholeCamera TestCamera() {
  return {.width = 3840, .height = 2160, .fx = 5686, .fy = 5680, .cx = 1926, .cy = 1088,
          .dist = {-0.07919, 0.01036, -0.000229, -1.8e-05, 0.002}};
}

TEST(PinholeCamera, UndistortionInvertsDistortion) {
  const PinholeCamera camera = TestCamera();
  for (double x = -0.4; x <= 0.4; x += 0.1) {
    for (double y = -0.25; y <= 0.25; y += 0.05) {
      const Eigen::Vector2d xy(x, y);
      EXPECT_LT((camera.NormalisedFromPixel(camera.PixelFromNormalised(xy)) - xy).norm(), 1e-11);
    }
  }
}

TEST(PinholeCamera, JacobianMatchesDifferences) {
  const PinholeCamera camera = TestCamera();
  const Eigen::Vector2d xy(0.21, -0.17);
  Eigen::Matrix2d jacobian;
  camera.PixelFromNormalised(xy, &jacobian);
  for (int k = 0; k < 2; ++k) {
    Eigen::Vector2d step = Eigen::Vector2d::Zero();
    step(k) = 1e-6;
    const Eigen::Vector2d slope = (camera.PixelFromNormalised(xy + step) - camera.PixelFromNormalised(xy - step)) / 2e-6;
    EXPECT_LT((slope - jacobian.col(k)).norm(), 1e-4);
  }
}

TEST(PinholeCamera, NothingBehindTheCameraIsSeen) { EXPECT_FALSE(TestCamera().Project({0, 0, -1}).has_value()); }

TEST(Sim3, FitRecoversAKnownSimilarity) {
  const Sim3 truth{2.5, Eigen::AngleAxisd(0.7, Eigen::Vector3d(1, 2, 3).normalized()).toRotationMatrix(), {4, -5, 6}};
  std::vector<Eigen::Vector3d> from = {{0, 0, 0}, {1, 0, 0}, {0, 2, 0}, {0.5, 1, 3}};
  std::vector<Eigen::Vector3d> to;
  for (const auto& p : from) to.push_back(truth * p);
  const auto fit = FitSim3(from, to);
  ASSERT_TRUE(fit.ok());
  EXPECT_NEAR(fit->scale, 2.5, 1e-12);
  for (std::size_t i = 0; i < from.size(); ++i) EXPECT_LT(((*fit) * from[i] - to[i]).norm(), 1e-12);
  EXPECT_LT((fit->Inverse() * to[3] - from[3]).norm(), 1e-12);
}

TEST(Sim3, DegenerateAlignmentIsRefused) {
  const std::vector<Eigen::Vector3d> line = {{0, 0, 0}, {1, 0, 0}, {2, 0, 0}};
  EXPECT_FALSE(FitSim3(line, line).ok());
  EXPECT_FALSE(FitSim3({{0, 0, 0}}, {{0, 0, 0}}).ok());
}

TEST(Sim3, ATransformedPoseSeesTheSamePicture) {
  const Sim3 new_from_old{3.0, Eigen::AngleAxisd(0.4, Eigen::Vector3d::UnitY()).toRotationMatrix(), {1, 2, 3}};
  const Rigid3 cam_from_old{Eigen::AngleAxisd(1.1, Eigen::Vector3d::UnitX()).toRotationMatrix(), {0.3, 0.2, 9}};
  const Eigen::Vector3d point(0.5, -0.2, 1.0);
  const Eigen::Vector3d before = cam_from_old * point;
  const Eigen::Vector3d after = TransformPose(cam_from_old, new_from_old) * (new_from_old * point);
  EXPECT_LT((before.hnormalized() - after.hnormalized()).norm(), 1e-12);
}

}  // namespace
}  // namespace drupe
