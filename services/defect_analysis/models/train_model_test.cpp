#include "defect_analysis/models/train_model.h"

#include <gtest/gtest.h>

#include <random>

#include "defect_analysis/models/colour_sample.h"

namespace drupe {
namespace {

Rgb8 Near(const Eigen::Vector3d& colour, std::mt19937_64& random) {
  std::normal_distribution<double> normal(0, 8);
  Rgb8 out;
  for (int c = 0; c < 3; ++c) out[c] = static_cast<std::uint8_t>(std::clamp(colour[c] + normal(random), 0.0, 255.0));
  return out;
}

// A green fruit with brown spots above a board in black and white, a grey needle.
LabelledColours Scene(std::uint64_t seed, int count = 6000) {
  std::mt19937_64 random(seed);
  LabelledColours scene;
  for (int k = 0; k < count; ++k) {
    scene.Add(Near(k % 12 == 0 ? Eigen::Vector3d(105, 106, 64) : Eigen::Vector3d(134, 155, 67), random), true);
    const Eigen::Vector3d board = k % 2 == 0 ? Eigen::Vector3d(230, 230, 228) : Eigen::Vector3d(28, 28, 28);
    scene.Add(Near(k % 50 == 0 ? Eigen::Vector3d(150, 150, 150) : board, random), false);
  }
  return scene;
}

TEST(TrainColourModel, TellsFruitFromBoardOnNewPoints) {
  for (const ColourSpace space : {ColourSpace::kLab, ColourSpace::kRgb}) {
    const auto model = TrainColourModel(Scene(1), Scene(2), {.space = space, .max_points = 500}, {});
    ASSERT_TRUE(model.ok()) << model.status().message();
    EXPECT_GT(model->training.Accuracy(), 0.995);
    EXPECT_GT(model->test.Accuracy(), 0.99);
    EXPECT_EQ(model->test.Points(), 12000);
    EXPECT_LT(model->vectors.size(), 300u);
  }
}

TEST(TrainColourModel, IsTheSameEveryTime) {
  const auto once = TrainColourModel(Scene(1), {}, {.max_points = 200}, {});
  RunContext one_thread;
  one_thread.threads = 1;
  const auto twice = TrainColourModel(Scene(1), {}, {.max_points = 200}, one_thread);
  ASSERT_TRUE(once.ok() && twice.ok());
  EXPECT_EQ(DumpJson(ToJson(*once)), DumpJson(ToJson(*twice)));
  EXPECT_EQ(once->test.Points(), 3000);  // a quarter was kept for it
}

TEST(TrainColourModel, KnowsOtherColoursWhenTrainedWithThem) {
  const auto plain = TrainColourModel(Scene(1), Scene(2), {.max_points = 500}, {});
  const auto recoloured = TrainColourModel(Scene(1), Scene(2), {.max_points = 1500, .recoloured = 8}, {});
  ASSERT_TRUE(plain.ok() && recoloured.ok());
  LabelledColours red;
  for (const Rgb8& colour : Scene(3, 2000).colours) red.Add(Recolour(colour, -75, 0.8), true);
  LabelledColours skin;
  for (std::size_t i = 0; i < red.size(); i += 2) skin.Add(red.colours[i], true);
  EXPECT_LT(JudgeColourModel(*recoloured, skin, 10000).FruitError(), 0.02);
  EXPECT_LE(JudgeColourModel(*recoloured, skin, 10000).FruitError(),
            JudgeColourModel(*plain, skin, 10000).FruitError());
  EXPECT_LT(recoloured->test.BackgroundError(), 0.02);
}

TEST(TrainColourModel, NeedsBothClasses) {
  LabelledColours fruit;
  for (int k = 0; k < 100; ++k) fruit.Add(Rgb8(10, 200, 10), true);
  EXPECT_EQ(TrainColourModel(fruit, {}, {}, {}).status().code(), "one_class");
  EXPECT_EQ(TrainColourModel({}, {}, {}, {}).status().code(), "one_class");
}

TEST(ParseTrainOptions, NamesTheFieldThatIsWrong) {
  EXPECT_EQ(ParseTrainOptions(Json{{"c", 0}}).status().field(), "c");
  EXPECT_EQ(ParseTrainOptions(Json{{"colour_space", "hsv"}}).status().field(), "colour_space");
  EXPECT_EQ(ParseTrainOptions(Json{{"name", "../x"}}).status().field(), "name");
  EXPECT_EQ(ParseTrainOptions(Json{{"kernel", "poly"}}).status().code(), "unknown_option");
  const auto options = ParseTrainOptions(Json{{"colour_space", "rgb"}, {"gamma", 2}});
  ASSERT_TRUE(options.ok());
  EXPECT_EQ(ToJson(*ParseTrainOptions(ToJson(*options))), ToJson(*options));
}

}  // namespace
}  // namespace drupe
