// Rigs that are not as they should be: what is reconstructed of their pictures, and what is said of the rest.
#include <gtest/gtest.h>

#include <cmath>
#include <string>

#include "reconstruction/damaged_rig.h"
#include "reconstruction/pipeline.h"

namespace drupe {
namespace {

constexpr double kFocalPx = 1886.2;  ///< of the sample's camera

/// Poses alone, from fewer features than usual: a test is to take a second or two.
ReconstructionOptions Quick() {
  ReconstructionOptions options;
  options.run_dense = false;
  options.features.first_octave = 0;
  options.features.max_features = 2'000;
  options.matching.exhaustive_features = 1'000;
  return options;
}

Result<ReconstructionOutput> Reconstruct(const DamagedRig& rig) {
  return RunReconstruction(rig.input(), Quick(), RunContext());
}

/// All pictures are registered, and within `limit_mm` of the truth.
void ExpectAllWithin(const DamagedRig& rig, double limit_mm) {
  const Result<ReconstructionOutput> output = Reconstruct(rig);
  ASSERT_TRUE(output.ok()) << output.status().ToString();
  EXPECT_EQ(output->model.RegisteredCount(), rig.size());
  EXPECT_EQ(output->model.scale_source, ScaleSource::kBoard);
  EXPECT_LT(rig.WorstCentreMm(output->model), limit_mm);
}

/// Every picture that is not registered comes with a reason.
void ExpectReasons(const ReconstructionOutput& output) {
  for (const View& view : output.model.views) EXPECT_NE(view.cam_from_world.has_value(), !view.reason.empty());
  EXPECT_EQ(QualityJson(output)["unregistered"].size(), output.model.views.size() - output.model.RegisteredCount());
}

TEST(RigsTest, EverySecondPicture) {
  DamagedRig rig;
  rig.KeepOnly([](int i) { return i % 2 == 0; });
  ASSERT_EQ(rig.size(), 18);
  ExpectAllWithin(rig, 0.1);
}

TEST(RigsTest, EveryThirdPictureMissing) {
  DamagedRig rig;
  rig.KeepOnly([](int i) { return i % 3 != 2; });
  ASSERT_EQ(rig.size(), 24);
  ExpectAllWithin(rig, 0.1);
}

TEST(RigsTest, RingThatDoesNotClose) {
  DamagedRig rig;
  rig.KeepOnly([](int i) { return i < 12 || i >= 18; });
  ASSERT_EQ(rig.size(), 30);
  ExpectAllWithin(rig, 0.1);
}

TEST(RigsTest, OneFrameTwice) {
  DamagedRig rig;
  rig.KeepOnly([](int i) { return i < 12; });
  rig.Repeat(5);
  ExpectAllWithin(rig, 0.1);
}

TEST(RigsTest, BlurredFramesLeaveTheOthersAlone) {
  DamagedRig rig;
  rig.KeepOnly([](int i) { return i < 15; });
  for (const int picture : {3, 7, 8}) rig.Blur(picture, 25);
  const Result<ReconstructionOutput> output = Reconstruct(rig);
  ASSERT_TRUE(output.ok()) << output.status().ToString();
  EXPECT_GE(output->model.RegisteredCount(), 12);
  EXPECT_LT(rig.WorstCentreMm(output->model), 0.5);
  ExpectReasons(*output);
  for (const int picture : {2, 4, 6, 9}) EXPECT_TRUE(output->model.views[picture].cam_from_world.has_value());
}

TEST(RigsTest, BoardHalfCovered) {
  DamagedRig rig;
  rig.KeepOnly([](int i) { return i % 2 == 0; });
  rig.CoverHalfTheBoard();
  ExpectAllWithin(rig, 0.2);
}

TEST(RigsTest, FruitWithAlmostNoTexture) {
  DamagedRig rig;
  rig.KeepOnly([](int i) { return i < 15; });
  rig.SmoothTheFruit(12);
  ExpectAllWithin(rig, 0.15);
}

TEST(RigsTest, NoCalibrationIsEstimatedAndSaidSo) {
  DamagedRig rig;
  rig.KeepOnly([](int i) { return i % 2 == 0; });
  rig.input().calibration.reset();
  const Result<ReconstructionOutput> output = Reconstruct(rig);
  ASSERT_TRUE(output.ok()) << output.status().ToString();
  EXPECT_EQ(output->model.RegisteredCount(), rig.size());
  EXPECT_EQ(output->model.intrinsics_source, IntrinsicsSource::kEstimated);
  EXPECT_NEAR(output->model.camera.fx / kFocalPx, 1, 0.02);
}

TEST(RigsTest, MostPicturesUselessFailsWithAdvice) {
  DamagedRig rig;
  rig.KeepOnly([](int i) { return i < 12; });
  for (int picture = 5; picture < 12; ++picture) rig.Blur(picture, 60);
  const Result<ReconstructionOutput> output = Reconstruct(rig);
  EXPECT_EQ(output.status().code(), "too_few_registered");
  for (const char* word : {"5 of 12", "board", "focus", "steps"}) {
    EXPECT_NE(output.status().message().find(word), std::string::npos) << output.status().message();
  }
}

}  // namespace
}  // namespace drupe
