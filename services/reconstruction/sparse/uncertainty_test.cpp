#include "reconstruction/sparse/uncertainty.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>

#include "geometry/sim3.h"
#include "reconstruction/sparse/synthetic_scene.h"

namespace drupe {
namespace {

/// Root mean square of actual error over sigma: 1 when the uncertainties are what they say.
class Calibration {
 public:
  void Add(double error, double sigma) {
    if (sigma <= 0) return;
    sum_ += error * error / (sigma * sigma);
    ++count_;
  }
  double Ratio() const { return std::sqrt(sum_ / std::max(1, count_)); }
  int count() const { return count_; }

 private:
  double sum_ = 0;
  int count_ = 0;
};

SyntheticScene::Options Honest() {
  SyntheticScene::Options options;
  options.wrong_share = 0;
  options.noise_px = 0.3;
  return options;
}

double Angle(const Eigen::Matrix3d& a, const Eigen::Matrix3d& b) {
  return Eigen::AngleAxisd(a.transpose() * b).angle();
}

TEST(UncertaintyTest, IsTheActualErrorOfViewsInTheBoardsFrame) {
  const SyntheticScene scene(Honest());
  const auto model = RunSparse(scene.Input(true), SparseOptions{}, RunContext{});
  ASSERT_TRUE(model.ok());
  Calibration centres, rotations;
  for (std::size_t v = 0; v < scene.poses.size(); ++v) {
    const View& view = model->views[v];
    centres.Add((view.cam_from_world->Centre() - scene.poses[v].Centre()).norm(), view.centre_sigma);
    rotations.Add(Angle(view.cam_from_world->rotation, scene.poses[v].rotation), view.rotation_sigma_deg * M_PI / 180);
  }
  EXPECT_EQ(centres.count(), 24);
  EXPECT_NEAR(centres.Ratio(), 1, 0.25);
  EXPECT_NEAR(rotations.Ratio(), 1, 0.25);
}

TEST(UncertaintyTest, IsTheActualErrorOfTracks) {
  const SyntheticScene scene(Honest());
  const auto model = RunSparse(scene.Input(true), SparseOptions{}, RunContext{});
  ASSERT_TRUE(model.ok());
  Calibration tracks;
  for (const Track& track : model->tracks) {
    const auto nearest = std::min_element(scene.points.begin(), scene.points.end(), [&](const auto& a, const auto& b) {
      return (a - track.position).squaredNorm() < (b - track.position).squaredNorm();
    });
    tracks.Add((*nearest - track.position).norm(), track.position_sigma);
  }
  EXPECT_GT(tracks.count(), 550);
  EXPECT_NEAR(tracks.Ratio(), 1, 0.1);
}

TEST(UncertaintyTest, FallsWithTheNoise) {
  SyntheticScene::Options low = Honest(), high = Honest();
  low.noise_px = 0.1, low.board_noise_px = 0.02;
  high.noise_px = 0.4, high.board_noise_px = 0.08;
  const SyntheticScene exact(low), rough(high);
  const auto a = RunSparse(exact.Input(true), SparseOptions{}, RunContext{});
  const auto b = RunSparse(rough.Input(true), SparseOptions{}, RunContext{});
  ASSERT_TRUE(a.ok() && b.ok());
  EXPECT_NEAR(b->views[3].centre_sigma / a->views[3].centre_sigma, 4, 0.8);
}

TEST(UncertaintyTest, WithoutABoardTheFirstViewIsTheFrame) {
  SyntheticScene::Options options = Honest();
  options.noise_px = 0.1;
  const SyntheticScene scene(options);
  const auto model = RunSparse(scene.Input(false), SparseOptions{}, RunContext{});
  ASSERT_TRUE(model.ok());
  EXPECT_EQ(model->views[0].centre_sigma, 0);
  // The truth in that frame and unit.
  double spread = 0;
  Eigen::Vector3d middle = Eigen::Vector3d::Zero();
  for (const Rigid3& pose : scene.poses) middle += pose.Centre() / 24;
  for (const Rigid3& pose : scene.poses) spread += (pose.Centre() - middle).norm() / 24;
  const Sim3 own_from_world{1 / spread, scene.poses[0].rotation, scene.poses[0].translation / spread};
  Calibration centres, rotations;
  for (std::size_t v = 1; v < scene.poses.size(); ++v) {
    const View& view = model->views[v];
    const Rigid3 truth = TransformPose(scene.poses[v], own_from_world);
    centres.Add((view.cam_from_world->Centre() - truth.Centre()).norm(), view.centre_sigma);
    rotations.Add(Angle(view.cam_from_world->rotation, truth.rotation), view.rotation_sigma_deg * M_PI / 180);
  }
  // All views share the error of the first, so the ratio scatters more than with a board.
  EXPECT_GT(centres.Ratio(), 0.4);
  EXPECT_LT(centres.Ratio(), 1.8);
  EXPECT_GT(rotations.Ratio(), 0.4);
  EXPECT_LT(rotations.Ratio(), 1.8);
}

TEST(UncertaintyTest, IsNotKnownWhereNothingHoldsAView) {
  SfmState state = MakeSfmState(SyntheticScene(Honest()).Input(false));
  state.poses[0] = state.poses[1] = Rigid3{};
  state.poses[1]->translation.x() = 1;
  const auto is_in_both = [&](const SfmTrack& t) {
    const auto observations = state.ObservationsOf(t);
    return observations[0].view == 0 && observations[1].view == 1;
  };
  const auto found = std::find_if(state.tracks.begin(), state.tracks.end(), is_in_both);
  ASSERT_NE(found, state.tracks.end());
  SfmTrack& track = *found;  // alone it cannot hold six parameters
  track.has_position = true;
  track.position = Eigen::Vector3d(0.3, 0.2, 5);
  for (SfmObservation& o : state.ObservationsOf(track)) o.is_active = o.view < 2;
  const auto uncertainty = EstimateUncertainty(state, {0.3, 0.1}, AdjustmentOptions{}, RunContext{});
  ASSERT_TRUE(uncertainty.ok());
  EXPECT_EQ(uncertainty->centre_sigma, std::vector<double>(24, 0.0));
}

}  // namespace
}  // namespace drupe
