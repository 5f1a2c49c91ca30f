#include "capture/calibration/guidance.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <algorithm>

namespace drupe {
namespace {

constexpr Checkerboard kGuidedPattern{.columns = 9, .rows = 6, .square_mm = 10};
constexpr int kWidth = 1000, kHeight = 800;
constexpr double kFocalPx = 1500;

/// Corners of the pattern `distance_mm` away, tilted about the picture's x and y axes, its middle at (x, y) pixels.
PatternCorners Corners(double tilt_x_deg, double tilt_y_deg, double distance_mm = 250, double x = 500, double y = 400) {
  constexpr double kDegree = 0.01745329252;
  const Eigen::Matrix3d r = (Eigen::AngleAxisd(tilt_x_deg * kDegree, Eigen::Vector3d::UnitX()) *
                             Eigen::AngleAxisd(tilt_y_deg * kDegree, Eigen::Vector3d::UnitY()))
                                .toRotationMatrix();
  const Eigen::Vector3d middle =
      distance_mm * Eigen::Vector3d((x - kWidth / 2) / kFocalPx, (y - kHeight / 2) / kFocalPx, 1);
  PatternCorners corners;
  for (int i = 0; i < kGuidedPattern.CornerCount(); ++i) {
    const Eigen::Vector2d mm =
        kGuidedPattern.CornerMm(i) - Eigen::Vector2d(kGuidedPattern.WidthMm(), kGuidedPattern.HeightMm()) / 2;
    const Eigen::Vector3d point = r * Eigen::Vector3d(mm.x(), mm.y(), 0) + middle;
    const Eigen::Vector2d pixel = kFocalPx * point.hnormalized() + Eigen::Vector2d(kWidth, kHeight) / 2;
    if (pixel.x() < 0 || pixel.y() < 0 || pixel.x() >= kWidth || pixel.y() >= kHeight) continue;
    corners.indices.push_back(i);
    corners.pixels.push_back(pixel);
  }
  return corners;
}

bool IsMissing(const Guidance& guidance, const std::string& kind, const std::string& side = "") {
  return std::any_of(guidance.missing.begin(), guidance.missing.end(),
                     [&](const MissingPose& pose) { return pose.kind == kind && pose.side == side; });
}

TEST(GuidanceTest, MeasuresPoses) {
  // About y by 30 degrees: x = right goes to negative z, nearer.
  const Guidance guidance =
      Guide({Corners(0, 30), Corners(-25, 0), Corners(0, 0, 500, 700, 300)}, kGuidedPattern, kWidth, kHeight);
  const PatternPose &turned = guidance.poses[0], &nodding = guidance.poses[1], &flat = guidance.poses[2];
  EXPECT_NEAR(turned.tilt_deg, 30, 2);
  EXPECT_GT(turned.nearer_x, 0.98);
  EXPECT_NEAR(nodding.tilt_deg, 25, 2);
  EXPECT_GT(nodding.nearer_y, 0.98);  // about x by -25 degrees the lower edge comes nearer
  EXPECT_NEAR(flat.centre_x, 0.7, 0.01);
  EXPECT_NEAR(flat.centre_y, 0.375, 0.01);
  EXPECT_NEAR(flat.distance / turned.distance, 2, 0.1);
  EXPECT_EQ(ToJson(turned)["nearer_side"], "right");
}

TEST(GuidanceTest, SaysWhatIsMissingUntilNothingIs) {
  std::vector<PatternCorners> pictures;
  const auto guide = [&] { return Guide(pictures, kGuidedPattern, kWidth, kHeight); };
  const Guidance nothing = guide();
  EXPECT_TRUE(IsMissing(nothing, "pictures"));
  EXPECT_TRUE(IsMissing(nothing, "fill"));
  pictures = {Corners(0, 30), Corners(0, -30)};
  EXPECT_FALSE(IsMissing(guide(), "tilt", "left"));
  EXPECT_FALSE(IsMissing(guide(), "tilt", "right"));
  EXPECT_TRUE(IsMissing(guide(), "tilt", "top"));
  EXPECT_TRUE(IsMissing(guide(), "distance"));
  EXPECT_TRUE(IsMissing(guide(), "coverage", "top left"));
  EXPECT_NE(ToJson(guide())["missing"][0]["advice"].get<std::string>().find("top edge comes nearer"),
            std::string::npos);
  for (const double tilt : {30.0, -30.0}) pictures.push_back(Corners(tilt, 0));
  for (const double x : {240.0, 760.0}) {
    for (const double y : {160.0, 400.0, 640.0}) pictures.push_back(Corners(5, 5, 320, x, y));
  }
  const Guidance complete = guide();
  EXPECT_TRUE(complete.missing.empty()) << ToJson(complete).dump(1);
  EXPECT_TRUE(ToJson(complete)["complete"].get<bool>());
}

TEST(GuidanceTest, KnowsAPictureThatShowsTheSame) {
  const Guidance guidance = Guide({Corners(0, 30), Corners(2, 28, 252, 510, 405), Corners(0, -30), Corners(0, 30, 300)},
                                  kGuidedPattern, kWidth, kHeight);
  const std::vector<PatternPose> kept = {guidance.poses[2], guidance.poses[0]};
  EXPECT_EQ(SimilarPose(guidance.poses[1], kept), 1);
  EXPECT_EQ(SimilarPose(guidance.poses[3], kept), -1);
}

}  // namespace
}  // namespace drupe
