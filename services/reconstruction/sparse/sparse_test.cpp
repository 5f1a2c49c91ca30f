#include "reconstruction/sparse/sparse.h"

#include <gtest/gtest.h>

#include "geometry/sim3.h"
#include "reconstruction/sparse/synthetic_scene.h"

namespace drupe {
namespace {

/// Mean distance of the camera centres from the truth after the best similarity.
double AlignedCentreError(const SyntheticScene& scene, const SparseModel& model) {
  std::vector<Eigen::Vector3d> from, to;
  for (std::size_t v = 0; v < scene.poses.size(); ++v) {
    if (!model.views[v].cam_from_world) continue;
    from.push_back(model.views[v].cam_from_world->Centre());
    to.push_back(scene.poses[v].Centre());
  }
  const auto fit = FitSim3(from, to);
  double sum = 0;
  for (std::size_t i = 0; i < from.size(); ++i) sum += (*fit * from[i] - to[i]).norm();
  return sum / static_cast<double>(from.size());
}

TEST(SparseTest, NominalBoardGivesMetricPoses) {
  const SyntheticScene scene;
  const auto model = RunSparse(scene.Input(true), SparseOptions{}, RunContext{});
  ASSERT_TRUE(model.ok()) << model.status().ToString();
  EXPECT_EQ(model->RegisteredCount(), 24);
  EXPECT_EQ(model->scale_source, ScaleSource::kBoard);
  EXPECT_LT(scene.MeanCentreError(*model), 0.01);
  EXPECT_GT(model->tracks.size(), 0.95 * scene.tracks.tracks.size());
  EXPECT_NEAR(model->board_rms_px, 0.05 * std::sqrt(2.0), 0.01);
  EXPECT_EQ(model->board_observations, 24 * 81 * 4);
  EXPECT_GT(model->scale_relative_sigma, 1e-8);
  EXPECT_LT(model->scale_relative_sigma, 1e-4);
}

TEST(SparseTest, NominalFeaturesAloneCloseTheRing) {
  SyntheticScene::Options options;
  options.noise_px = 0.1;
  const SyntheticScene scene(options);
  const auto model = RunSparse(scene.Input(false), SparseOptions{}, RunContext{});
  ASSERT_TRUE(model.ok()) << model.status().ToString();
  EXPECT_EQ(model->RegisteredCount(), 24);
  EXPECT_EQ(model->scale_source, ScaleSource::kNone);
  // The ball fills a tenth of the picture, so noise in its features is turned into ten times as much of the cameras.
  EXPECT_LT(AlignedCentreError(scene, *model), 0.3);
  EXPECT_LT(model->mean_reprojection_error_px, 0.2);
  EXPECT_TRUE(model->views[0].cam_from_world->rotation.isIdentity(1e-9));  // the frame of the first view
}

ViewClusters FourArcs() {
  ViewClusters clusters;
  for (int first = 0; first < 24; first += 6) {
    std::vector<int> arc;
    for (int k = 0; k < 9; ++k) arc.push_back((first + k) % 24);
    std::sort(arc.begin(), arc.end());
    clusters.clusters.push_back(arc);
  }
  return clusters;
}

TEST(SparseTest, ThreadsDoNotChangeTheResult) {
  const SyntheticScene scene;
  const ViewClusters clusters = FourArcs();
  SparseInput input = scene.Input(false);
  input.clusters = &clusters;
  RunContext one, three;
  one.threads = 1, three.threads = 3;
  const auto a = RunSparse(input, SparseOptions{}, one), b = RunSparse(input, SparseOptions{}, three);
  ASSERT_TRUE(a.ok() && b.ok());
  ASSERT_EQ(a->tracks.size(), b->tracks.size());
  EXPECT_EQ(a->views[17].cam_from_world->translation, b->views[17].cam_from_world->translation);
  EXPECT_EQ(a->tracks.back().position, b->tracks.back().position);
}

// Each cluster with nothing but its bytes, as another machine does it, and the last one first.
TEST(SparseTest, ClustersBuiltElsewhereGiveTheSameModel) {
  const SyntheticScene scene;
  const ViewClusters clusters = FourArcs();
  for (const bool with_board : {false, true}) {
    SparseInput input = scene.Input(with_board);
    input.clusters = &clusters;
    const auto here = RunSparse(input, SparseOptions{}, RunContext{});
    SparseOptions options;
    options.parts = true;
    std::size_t done = 0;
    input.run_parts = [&](const StageParts& parts) -> Result<std::vector<std::string>> {
      std::vector<std::string> results(parts.parts.size());
      for (std::size_t k = results.size(); k-- > 0; ++done) {
        DRUPE_ASSIGN_OR_RETURN(results[k], RunSparsePart(std::string(parts.parts[k]), options, RunContext()));
      }
      return results;
    };
    const auto there = RunSparse(input, options, RunContext{});
    ASSERT_TRUE(here.ok() && there.ok()) << there.status().ToString();
    EXPECT_EQ(done, 4u);
    ASSERT_EQ(here->tracks.size(), there->tracks.size());
    for (std::size_t v = 0; v < here->views.size(); ++v) {
      EXPECT_EQ(here->views[v].cam_from_world->translation, there->views[v].cam_from_world->translation);
      EXPECT_EQ(here->views[v].cam_from_world->rotation, there->views[v].cam_from_world->rotation);
    }
    for (std::size_t t = 0; t < here->tracks.size(); ++t) {
      ASSERT_EQ(here->tracks[t].position, there->tracks[t].position);
    }
  }
}

TEST(SparseTest, RefusesPartsAndResultsThatAreDamaged) {
  const SyntheticScene scene;
  const ViewClusters clusters = FourArcs();
  SparseInput input = scene.Input(false);
  input.clusters = &clusters;
  SparseOptions options;
  options.parts = true;
  input.run_parts = [&](const StageParts& parts) -> Result<std::vector<std::string>> {
    const std::string& part = parts.parts[0];
    for (const std::size_t cut : {std::size_t{0}, std::size_t{100}, part.size() / 2, part.size() - 1}) {
      EXPECT_EQ(RunSparsePart(part.substr(0, cut), options, RunContext()).status().code(), "bad_part") << cut;
    }
    EXPECT_EQ(RunSparsePart(part + "x", options, RunContext()).status().code(), "bad_part");
    std::string lying = part;
    std::fill(lying.begin() + 80, lying.begin() + 96, '\xff');  // in the number of observations, and after it
    EXPECT_EQ(RunSparsePart(lying, options, RunContext()).status().code(), "bad_part");
    DRUPE_ASSIGN_OR_RETURN(const std::string result, parts.here(0));
    return std::vector<std::string>(parts.parts.size(), result);  // another cluster's
  };
  EXPECT_EQ(RunSparse(input, options, RunContext{}).status().code(), "bad_part");
}

TEST(SparseTest, ClustersFusedAreAsGoodAsTheWhole) {
  SyntheticScene::Options scene_options;
  scene_options.noise_px = 0.1;
  const SyntheticScene scene(scene_options);
  const ViewClusters clusters = FourArcs();
  for (const bool with_board : {false, true}) {
    SparseInput input = scene.Input(with_board);
    input.clusters = &clusters;
    SparseOptions options;
    const auto fused = RunSparse(input, options, RunContext{});
    options.method = SparseMethod::kWhole;
    const auto whole = RunSparse(input, options, RunContext{});
    ASSERT_TRUE(fused.ok() && whole.ok());
    EXPECT_EQ(fused->RegisteredCount(), 24);
    EXPECT_LT(AlignedCentreError(scene, *fused), 1.05 * AlignedCentreError(scene, *whole) + 1e-4);
    EXPECT_GE(fused->tracks.size(), 0.99 * whole->tracks.size());
  }
}

TEST(SparseTest, AClusterThatCannotBeBuiltIsPlacedByTheOthers) {
  SyntheticScene scene;
  std::erase_if(scene.matches.pairs, [](const TwoViewMatches& p) { return p.pair.first >= 6 && p.pair.first <= 14; });
  const ViewClusters clusters = FourArcs();
  SparseInput input = scene.Input(false);
  input.clusters = &clusters;
  const auto model = RunSparse(input, SparseOptions{}, RunContext{});
  ASSERT_TRUE(model.ok()) << model.status().ToString();
  EXPECT_EQ(model->RegisteredCount(), 24);
}

TEST(SparseTest, BothAdjustmentsGiveOneModel) {
  const SyntheticScene scene;
  SparseOptions options;
  const auto distributed = RunSparse(scene.Input(true), options, RunContext{});
  options.adjustment = AdjustmentMethod::kMonolithic;
  const auto monolithic = RunSparse(scene.Input(true), options, RunContext{});
  ASSERT_TRUE(distributed.ok() && monolithic.ok());
  EXPECT_LT((distributed->views[7].cam_from_world->Centre() - monolithic->views[7].cam_from_world->Centre()).norm(),
            1e-3);
  EXPECT_NEAR(distributed->mean_reprojection_error_px, monolithic->mean_reprojection_error_px, 1e-4);
}

TEST(SparseTest, ViewWithoutFeaturesIsPlacedByTheBoard) {
  SyntheticScene scene;
  scene.Blind(5);
  const auto model = RunSparse(scene.Input(true), SparseOptions{}, RunContext{});
  ASSERT_TRUE(model.ok()) << model.status().ToString();
  EXPECT_EQ(model->RegisteredCount(), 24);
  EXPECT_EQ(model->views[5].observation_count, 0);
  EXPECT_LT(scene.MeanCentreError(*model), 0.02);
}

TEST(SparseTest, BoardSeenInAFewViewsGivesTheScaleOfAll) {
  SyntheticScene scene;
  for (std::size_t v = 0; v < scene.detections.size(); ++v) {
    if (v % 6 != 0) scene.detections[v].clear();
    if (scene.detections[v].size() > 5) scene.detections[v].resize(5);  // the rest is hidden
  }
  const ViewClusters clusters = FourArcs();
  for (const ViewClusters* divided : {static_cast<const ViewClusters*>(nullptr), &clusters}) {
    SparseInput input = scene.Input(true);
    input.clusters = divided;
    const auto model = RunSparse(input, SparseOptions{}, RunContext{});
    ASSERT_TRUE(model.ok()) << model.status().ToString();
    EXPECT_EQ(model->RegisteredCount(), 24);
    EXPECT_EQ(model->scale_source, ScaleSource::kBoard);
    EXPECT_LT(scene.MeanCentreError(*model), 0.5);
  }
}

TEST(SparseTest, WrongCornersDoNotMoveTheFrame) {
  SyntheticScene scene;
  for (BoardDetection& detection : scene.detections) {
    for (int k = 0; k < 4; ++k) detection[3].corners_px[k] += Eigen::Vector2d(9, -6);
    detection[40].corners_px[1] += Eigen::Vector2d(2, 2);
  }
  const auto model = RunSparse(scene.Input(true), SparseOptions{}, RunContext{});
  ASSERT_TRUE(model.ok());
  EXPECT_LT(scene.MeanCentreError(*model), 0.02);
}

TEST(SparseTest, MarkersPrintedTooLargeDoNotBendThePoses) {
  SyntheticScene::Options options;
  options.ink_spread_mm = 0.05;
  const SyntheticScene scene(options);
  const auto model = RunSparse(scene.Input(true), SparseOptions{}, RunContext{});
  ASSERT_TRUE(model.ok());
  EXPECT_LT(scene.MeanCentreError(*model), 0.01);
  EXPECT_NEAR(model->board_rms_px, 0.05 * std::sqrt(2.0), 0.01);
}

TEST(SparseTest, UnregisteredViewSaysWhy) {
  SyntheticScene scene;
  scene.Blind(7);
  const auto model = RunSparse(scene.Input(false), SparseOptions{}, RunContext{});
  ASSERT_TRUE(model.ok());
  EXPECT_EQ(model->RegisteredCount(), 23);
  EXPECT_FALSE(model->views[7].cam_from_world);
  EXPECT_EQ(model->views[7].reason, "shares 0 points with the other pictures, 15 are needed");
}

TEST(SparseTest, RefinedIntrinsicsReturnToTheTruth) {
  const SyntheticScene scene;
  SparseInput input = scene.Input(true);
  input.camera.fx *= 1.02, input.camera.fy *= 1.02;
  input.refine_intrinsics = true;
  const auto model = RunSparse(input, SparseOptions{}, RunContext{});
  ASSERT_TRUE(model.ok());
  EXPECT_NEAR(model->camera.fx, scene.camera.fx, 2.0);
  EXPECT_LT(scene.MeanCentreError(*model), 0.3);
}

TEST(SparseTest, BoardShowsTheFocalLengthOfAnUnknownLens) {
  const SyntheticScene scene;
  SparseInput input = scene.Input(true);
  input.camera.fx = input.camera.fy = 1.2 * 1280;  // 15 % short
  input.camera.dist = {};
  input.intrinsics_source = IntrinsicsSource::kEstimated;
  input.refine_intrinsics = true;
  const auto model = RunSparse(input, SparseOptions{}, RunContext{});
  ASSERT_TRUE(model.ok()) << model.status().ToString();
  EXPECT_EQ(model->RegisteredCount(), 24);
  EXPECT_NEAR(model->camera.fx / scene.camera.fx, 1.0, 0.01);
}

TEST(SparseTest, UnknownLensWithoutABoardSaysWhatIsMissing) {
  SyntheticScene scene;
  for (TwoViewMatches& pair : scene.matches.pairs) pair.calibrated = false;
  const Status status = RunSparse(scene.Input(false), SparseOptions{}, RunContext{}).status();
  EXPECT_EQ(status.code(), "no_initial_pair");
  EXPECT_NE(status.message().find("calibration"), std::string::npos);
}

TEST(SparseTest, TooFewRegisteredIsAnError) {
  SyntheticScene scene;
  for (int v = 8; v < 24; ++v) scene.Blind(v);
  const auto model = RunSparse(scene.Input(false), SparseOptions{}, RunContext{});
  ASSERT_FALSE(model.ok());
  EXPECT_EQ(model.status().kind(), StatusKind::kUnprocessable);
  EXPECT_EQ(model.status().code(), "too_few_registered");
  EXPECT_NE(model.status().message().find("8 of 24"), std::string::npos);
}

TEST(SparseTest, EmptyMatchesAreAnError) {
  SyntheticScene scene;
  scene.matches.pairs.clear();
  EXPECT_EQ(RunSparse(scene.Input(false), SparseOptions{}, RunContext{}).status().code(), "no_initial_pair");
}

TEST(SparseTest, RefusesInputThatDoesNotFitTogether) {
  SyntheticScene scene;
  scene.tracks.tracks[0][0].keypoint = 1'000'000;
  EXPECT_EQ(RunSparse(scene.Input(false), SparseOptions{}, RunContext{}).status().code(), "invalid_sparse_input");
  ViewClusters clusters;
  clusters.clusters = {{0, 1, 24}, {2, 3}};
  const SyntheticScene sound;
  SparseInput input = sound.Input(false);
  input.clusters = &clusters;
  EXPECT_EQ(RunSparse(input, SparseOptions{}, RunContext{}).status().code(), "invalid_sparse_input");
  SparseOptions options;
  options.min_registered_share = 2;
  EXPECT_EQ(RunSparse(scene.Input(false), options, RunContext{}).status().field(), "sparse.min_registered_share");
}

TEST(SparseTest, StopsWhenCancelled) {
  const SyntheticScene scene;
  RunContext context;
  context.cancelled = [] { return true; };
  EXPECT_EQ(RunSparse(scene.Input(false), SparseOptions{}, context).status().kind(), StatusKind::kCancelled);
}

}  // namespace
}  // namespace drupe
