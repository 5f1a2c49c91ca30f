#include "reconstruction/dense/dense.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <atomic>
#include <cmath>

#include "base/clock.h"
#include "reconstruction/dense/synthetic_scene.h"
#include "scene/ply.h"

namespace drupe::dense {
namespace {

const Eigen::Vector3f kCentre(0, 0, 25);
constexpr float kRadius = 12;

const SyntheticScene& Ball() {
  static const SyntheticScene scene = MakeBallScene();
  return scene;
}

DenseInput InputOf(const SyntheticScene& scene) {
  return {&scene.model, [&scene](int view) -> Result<RgbImage> { return scene.pictures[view].Clone(); }};
}

Result<PointCloud> RunBall(int threads) {
  RunContext context;
  context.threads = threads;
  return RunDense(InputOf(Ball()), DenseOptions(), context);
}

const PointCloud& BallCloud() {
  static const PointCloud cloud = RunBall(1).value();
  return cloud;
}

float Percentile(std::vector<float> values, double share) {
  const auto at = values.begin() + static_cast<std::ptrdiff_t>(share * static_cast<double>(values.size() - 1));
  std::nth_element(values.begin(), at, values.end());
  return *at;
}

TEST(DenseTest, RebuildsABall) {
  const PointCloud& cloud = BallCloud();
  ASSERT_GT(cloud.size(), 15'000u);
  std::vector<float> errors, turns;
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    const Eigen::Vector3f outward = cloud.positions[i] - kCentre;
    errors.push_back(std::abs(outward.norm() - kRadius));
    turns.push_back(1 - cloud.normals[i].dot(outward.normalized()));
  }
  // A pixel is 0.22 wide on the ball.
  EXPECT_LT(Percentile(errors, 0.5), 0.03f);
  EXPECT_LT(Percentile(errors, 0.99), 0.15f);
  EXPECT_LT(Percentile(turns, 0.95), 1 - std::cos(0.12f));
}

TEST(DenseTest, CoversEverythingThatIsSeen) {
  const PointCloud& cloud = BallCloud();
  constexpr int kColumns = 24, kRows = 12;
  std::vector<int> hits(kColumns * kRows, 0);
  for (const Eigen::Vector3f& position : cloud.positions) {
    const Eigen::Vector3f d = (position - kCentre).normalized();
    const int column = static_cast<int>((std::atan2(d.y(), d.x()) + M_PI) / (2 * M_PI) * kColumns) % kColumns;
    const int row = std::clamp(static_cast<int>((d.z() + 1) / 2 * kRows), 0, kRows - 1);
    ++hits[row * kColumns + column];
  }
  // The views look down at 23 degrees: what lies below z = -0.5 is seen at more than 70 degrees.
  for (int row = 3; row < kRows; ++row) {
    for (int column = 0; column < kColumns; ++column)
      EXPECT_GT(hits[row * kColumns + column], 10) << row << " " << column;
  }
}

TEST(DenseTest, FillsEveryAttribute) {
  const PointCloud& cloud = BallCloud();
  ASSERT_EQ(cloud.normals.size(), cloud.size());
  ASSERT_EQ(cloud.colours.size(), cloud.size());
  ASSERT_EQ(cloud.raw_colours.size(), cloud.size());
  ASSERT_EQ(cloud.view_counts.size(), cloud.size());
  ASSERT_EQ(cloud.ncc.size(), cloud.size());
  ASSERT_EQ(cloud.expected_error.size(), cloud.size());
  double colour_error = 0, views = 0;
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    colour_error += std::abs(cloud.colours[i][1] - (60 + 120 * TextureAt(cloud.positions[i].cast<double>())));
    views += cloud.view_counts[i];
    ASSERT_GT(cloud.expected_error[i], 0);
    ASSERT_LE(cloud.ncc[i], 1.001f);
  }
  EXPECT_LT(colour_error / static_cast<double>(cloud.size()), 8);
  EXPECT_GT(views / static_cast<double>(cloud.size()), 3);
}

TEST(DenseTest, DoesNotDependOnTheNumberOfThreads) {
  const Result<PointCloud> two = RunBall(2);
  ASSERT_TRUE(two.ok());
  EXPECT_TRUE(WritePly(BallCloud()) == WritePly(*two));
}

/// The ball as a glossy fruit on a turntable: in every picture the same lamp mirrors at the same place, which moves
/// over the skin from view to view.
SyntheticScene GlossyBall() {
  SyntheticScene scene = MakeBallScene();
  for (RgbImage& picture : scene.pictures) {
    for (int y = 0; y < picture.height(); ++y) {
      for (int x = 0; x < picture.width(); ++x) {
        const double distance2 = std::pow((x - 126) / 5.0, 2) + std::pow((y - 84) / 4.0, 2);
        const double gloss = 190 * std::exp(-distance2);
        for (int c = 0; c < 3; ++c) {
          picture.At(x, y, c) = static_cast<std::uint8_t>(std::min(255.0, picture.At(x, y, c) + gloss));
        }
      }
    }
  }
  return scene;
}

// Each part with nothing but its bytes and pictures by name, as another machine does it, and the last one first.
TEST(DenseTest, PartsDoneElsewhereGiveTheSameCloud) {
  const SyntheticScene& scene = Ball();
  DenseOptions options;
  options.parts = 5;
  const auto named = [&](const std::string& image) -> Result<RgbImage> {
    for (std::size_t view = 0; view < scene.pictures.size(); ++view) {
      if (scene.model.views[view].image == image) return scene.pictures[view].Clone();
    }
    return Internal("unknown", image);
  };
  DenseInput input = InputOf(scene);
  std::size_t done = 0;
  input.run_parts = [&](const StageParts& parts) -> Result<std::vector<std::string>> {
    EXPECT_EQ(parts.parts.size(), 5u);
    std::vector<std::string> results(parts.parts.size());
    for (std::size_t k = results.size(); k-- > 0;) {
      DRUPE_ASSIGN_OR_RETURN(results[k], RunDensePart(std::string(parts.parts[k]), options, named, RunContext()));
      parts.done(k);
      ++done;
    }
    return results;
  };
  const Result<PointCloud> cloud = RunDense(input, options, RunContext());
  ASSERT_TRUE(cloud.ok()) << cloud.status().ToString();
  EXPECT_EQ(done, 5u);
  EXPECT_TRUE(WritePly(*cloud) == WritePly(BallCloud()));
}

TEST(DenseTest, RefusesPartsAndResultsThatAreDamaged) {
  const SyntheticScene& scene = Ball();
  DenseOptions options;
  options.parts = 2;
  const auto any = [&](const std::string&) -> Result<RgbImage> { return scene.pictures[0].Clone(); };
  DenseInput input = InputOf(scene);
  input.run_parts = [&](const StageParts& parts) -> Result<std::vector<std::string>> {
    const std::string& part = parts.parts[0];
    for (const std::size_t cut : {std::size_t{0}, part.find('\n') / 2, part.find('\n') + 1, part.size() - 1}) {
      EXPECT_EQ(RunDensePart(part.substr(0, cut), options, any, RunContext()).status().kind(),
                StatusKind::kUnprocessable)
          << cut;
    }
    DRUPE_ASSIGN_OR_RETURN(std::string result, parts.here(0));
    return std::vector<std::string>{result.substr(0, result.size() - 1), result};
  };
  EXPECT_EQ(RunDense(input, options, RunContext()).status().code(), "bad_part");
}

TEST(DenseTest, HighlightsLeaveNoTrace) {
  const SyntheticScene scene = GlossyBall();
  const Result<PointCloud> cloud = RunDense(InputOf(scene), DenseOptions(), RunContext());
  ASSERT_TRUE(cloud.ok());
  EXPECT_GT(cloud->size(), BallCloud().size() * 9 / 10);  // nor a hole
  std::vector<float> errors, brighter;
  for (std::size_t i = 0; i < cloud->size(); ++i) {
    errors.push_back(std::abs((cloud->positions[i] - kCentre).norm() - kRadius));
    const double skin = 60 + 120 * TextureAt(cloud->positions[i].cast<double>());
    brighter.push_back(static_cast<float>(cloud->raw_colours[i][1] - skin));
  }
  EXPECT_LT(Percentile(errors, 0.5), 0.03f);
  EXPECT_LT(Percentile(errors, 0.99), 0.2f);
  EXPECT_LT(Percentile(brighter, 0.99), 25);  // the lamp adds up to 190
}

TEST(DenseTest, ErrorsAreAboutAsLargeAsExpected) {
  const SyntheticScene scene = GlossyBall();
  const Result<PointCloud> cloud = RunDense(InputOf(scene), DenseOptions(), RunContext());
  ASSERT_TRUE(cloud.ok());
  std::vector<float> ratios;
  for (std::size_t i = 0; i < cloud->size(); ++i) {
    const float error = std::abs((cloud->positions[i] - kCentre).norm() - kRadius);
    ratios.push_back(error / cloud->expected_error[i]);
  }
  const float ratio = Percentile(ratios, 0.683);  // 1 where the estimate is right
  EXPECT_GT(ratio, 0.6f);
  EXPECT_LT(ratio, 1.6f);
}

TEST(DenseTest, StopsWhenCancelled) {
  std::atomic<bool> stop = false;
  RunContext context;
  context.threads = 1;
  context.progress = [&](std::string_view, double) { stop = true; };
  context.cancelled = [&] { return stop.load(); };
  const Result<PointCloud> cloud = RunDense(InputOf(Ball()), DenseOptions(), context);
  EXPECT_EQ(cloud.status().kind(), StatusKind::kCancelled);
}

TEST(DenseTest, StopsSoonWhereverItIsCancelled) {
  for (const double from : {0.0, 0.16, 0.5, 0.9}) {
    std::atomic<double> asked_s = -1;  // CPU time, which does not depend on what else the machine does
    RunContext context;
    context.threads = 1;
    context.progress = [&](std::string_view, double done) {
      if (done >= from && asked_s < 0) asked_s = ProcessCpuSeconds();
    };
    context.cancelled = [&] { return asked_s >= 0; };
    const Result<PointCloud> cloud = RunDense(InputOf(Ball()), DenseOptions(), context);
    const double took_s = ProcessCpuSeconds() - asked_s;
    EXPECT_EQ(cloud.status().kind(), StatusKind::kCancelled) << from;
    EXPECT_LT(took_s, 0.5) << from;
  }
}

TEST(DenseTest, ReportsProgressThatOnlyGrows) {
  double last = 0;
  int reports = 0;
  RunContext context;
  context.progress = [&](std::string_view stage, double done) {
    EXPECT_EQ(stage, "dense");
    EXPECT_GE(done, last);
    last = done;
    ++reports;
  };
  ASSERT_TRUE(RunDense(InputOf(Ball()), DenseOptions(), context).ok());
  EXPECT_EQ(last, 1.0);
  EXPECT_GT(reports, 30);
}

TEST(DenseTest, SaysWhyNothingCanBeDone) {
  SparseModel model = Ball().model;
  DenseInput input = InputOf(Ball());
  input.model = &model;
  model.tracks.clear();
  EXPECT_EQ(RunDense(input, DenseOptions(), RunContext()).status().code(), "no_seeds");
  model = Ball().model;
  for (std::size_t i = 2; i < model.views.size(); ++i) model.views[i].cam_from_world.reset();
  EXPECT_EQ(RunDense(input, DenseOptions(), RunContext()).status().code(), "too_few_views");
  model = Ball().model;
  input.load_rgb = [](int) -> Result<RgbImage> { return RgbImage(64, 64, 3); };
  EXPECT_EQ(RunDense(input, DenseOptions(), RunContext()).status().code(), "image_size_mismatch");
  input.load_rgb = [](int) -> Result<RgbImage> { return NotFound("image_gone", "gone"); };
  EXPECT_EQ(RunDense(input, DenseOptions(), RunContext()).status().code(), "image_gone");
}

TEST(DenseOptionsTest, NamesTheFieldThatIsWrong) {
  DenseOptions options;
  EXPECT_TRUE(options.Check().ok());
  options.wsize = 8;
  EXPECT_EQ(options.Check().field(), "wsize");
  options = DenseOptions();
  options.threshold = std::nan("");
  EXPECT_EQ(options.Check().field(), "threshold");
  options = DenseOptions();
  options.level = 7;
  EXPECT_EQ(options.Check().field(), "level");
}

}  // namespace
}  // namespace drupe::dense
