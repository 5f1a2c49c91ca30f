#include <gtest/gtest.h>

#include <random>

#include "defect_analysis/fruit/colour_classifier.h"
#include "defect_analysis/fruit/extract_fruits.h"
#include "defect_analysis/fruit/foreign_colours.h"
#include "scene/synthetic_fruit.h"

namespace drupe {
namespace {

// Green is fruit, grey is background.
ColourModel GreenAgainstGrey(ColourSpace space) {
  ColourModel model;
  model.name = "green";
  model.space = space;
  const std::vector<std::pair<Rgb8, float>> vectors = {{Rgb8(134, 155, 67), 4.0f},   {Rgb8(105, 106, 64), 3.0f},
                                                       {Rgb8(60, 60, 60), -3.0f},    {Rgb8(150, 150, 150), -3.5f},
                                                       {Rgb8(235, 235, 235), -4.0f}, {Rgb8(20, 20, 20), -4.0f}};
  model.mean = space == ColourSpace::kLab ? Eigen::Vector3f(50, 0, 15) : Eigen::Vector3f(120, 120, 100);
  model.scale = space == ColourSpace::kLab ? Eigen::Vector3f(30, 10, 20) : Eigen::Vector3f(70, 70, 70);
  model.gamma = 0.8f;
  model.bias = -0.2f;
  for (const auto& [colour, weight] : vectors) {
    model.vectors.push_back((PlaceOf(colour, space) - model.mean).cwiseQuotient(model.scale));
    model.weights.push_back(weight);
  }
  return model;
}

TEST(ColourClassifier, AgreesWithTheDirectSumOfKernels) {
  for (const ColourSpace space : {ColourSpace::kLab, ColourSpace::kRgb}) {
    const ColourModel model = GreenAgainstGrey(space);
    std::mt19937_64 random(5);
    std::vector<Rgb8> colours = {Rgb8(0, 0, 0), Rgb8(255, 255, 255), Rgb8(0, 0, 255), Rgb8(255, 0, 255)};
    for (int k = 0; k < 20000; ++k) {
      colours.emplace_back(random() % 256, random() % 256, random() % 256);
    }
    const std::vector<float> decisions = ColourClassifier(model).Decide(colours);
    for (std::size_t i = 0; i < colours.size(); ++i) {
      ASSERT_NEAR(decisions[i], model.Decide(colours[i]), 0.1) << colours[i].cast<int>().transpose();
    }
  }
}

// A fruit on its needle, whose upper end lies in the shell of points that the surface's tolerance lets pass.
struct Scene {
  PointCloud cloud;
  std::size_t skin = 0;
};

Scene FruitWithDirt(const Rgb8& dirt, int recolour) {
  SyntheticFruit fruit;
  fruit.points = 40000;
  Scene scene;
  fruit.AddTo(scene.cloud);
  scene.skin = scene.cloud.size();
  for (Rgb8& colour : scene.cloud.colours) {
    if (recolour != 0) colour = Rgb8(colour[recolour], colour[recolour], colour[recolour]);
  }
  for (int k = 0; k < 400; ++k) {
    const double turn = 0.01 * k;
    const Eigen::Vector3d direction(std::cos(turn), std::sin(turn), 0.3 * std::sin(3 * turn));
    scene.cloud.positions.push_back((fruit.centre + 18.45 * direction.normalized()).cast<float>());
    scene.cloud.colours.push_back(dirt);
  }
  scene.cloud.normals.clear();
  return scene;
}

std::size_t PointsFound(const Scene& scene, const ColourModel* model) {
  FruitScene where;
  where.metric = true;
  where.background_model = model;
  const auto fruits = ExtractFruits(scene.cloud, where, {}, {}, {});
  return fruits.ok() && fruits->size() == 1 ? (*fruits)[0].size() : 0;
}

TEST(ExtractFruits, ColourTakesOffWhatTheSurfaceLeavesInDoubt) {
  const ColourModel model = GreenAgainstGrey(ColourSpace::kLab);
  const Scene grey = FruitWithDirt(Rgb8(150, 150, 150), 0);
  const std::size_t by_geometry = PointsFound(grey, nullptr);
  EXPECT_NEAR(static_cast<double>(by_geometry - PointsFound(grey, &model)), 400, 5);
  const Scene green = FruitWithDirt(Rgb8(134, 155, 67), 0);
  EXPECT_EQ(PointsFound(green, &model), PointsFound(green, nullptr));
}

TEST(ExtractFruits, ColourHasNoSayOverFruitThatItDoesNotKnow) {
  const ColourModel model = GreenAgainstGrey(ColourSpace::kLab);
  const Scene scene = FruitWithDirt(Rgb8(150, 150, 150), 1);  // a grey fruit
  EXPECT_GT(PointsFound(scene, nullptr), scene.skin - 1000);
  EXPECT_EQ(PointsFound(scene, &model), PointsFound(scene, nullptr));
}

TEST(ExtractFruits, ColourFindsTheFruitWhereGeometryFindsNone) {
  SyntheticFruit fruit;
  fruit.points = 40000;
  PointCloud cloud;
  fruit.AddTo(cloud);
  const std::size_t skin = cloud.size();
  std::mt19937_64 random(3);
  std::uniform_real_distribution<float> uniform(-30, 30);
  for (int k = 0; k < 150000; ++k) {  // a grey haze all around and through it, denser than any threshold of voxels
    cloud.positions.emplace_back(uniform(random), uniform(random), 34 + uniform(random));
    cloud.colours.emplace_back(60, 60, 60);
  }
  cloud.normals.clear();
  const ColourModel model = GreenAgainstGrey(ColourSpace::kLab);
  EXPECT_EQ(PointsFound({cloud, skin}, nullptr), 0u);
  EXPECT_GT(PointsFound({cloud, skin}, &model), skin - 1000);
}

TEST(ParseBackgroundOptions, NamesTheFieldThatIsWrong) {
  EXPECT_EQ(ParseBackgroundOptions(Json{{"model", "../x"}}, "options.background").status().field(), "background.model");
  EXPECT_EQ(ParseBackgroundOptions(Json{{"known_share", 2}}, "b").status().field(), "background.known_share");
  EXPECT_EQ(ParseBackgroundOptions(Json{{"colour", 2}}, "b").status().code(), "unknown_option");
  EXPECT_EQ(ParseBackgroundOptions(Json{{"model", "mdl_0a1b"}}, "b")->model, "mdl_0a1b");
}

}  // namespace
}  // namespace drupe
