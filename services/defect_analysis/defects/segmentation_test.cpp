#include "defect_analysis/defects/segmentation.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <random>

#include "defect_analysis/defects/healthy_skin.h"
#include "defect_analysis/defects/point_classes.h"
#include "defect_analysis/defects/skin_map.h"

namespace drupe {
namespace {

// Healthy skin about zero, brown spots, and a few cells of dark cracks.
std::vector<Eigen::Vector3f> Deviations(int count) {
  std::mt19937_64 random(4);
  std::normal_distribution<float> normal(0, 1.2f);
  std::vector<Eigen::Vector3f> deviations;
  for (int k = 0; k < count; ++k) {
    const Eigen::Vector3f middle = k % 40 == 0
                                       ? Eigen::Vector3f(-9, 11, -16)
                                       : (k % 333 == 1 ? Eigen::Vector3f(-20, 2, -25) : Eigen::Vector3f::Zero());
    deviations.push_back(middle + Eigen::Vector3f(normal(random), normal(random), normal(random)));
  }
  return deviations;
}

int Nearest(const Eigen::Vector3f& colour, const std::vector<Eigen::Vector3f>& centres) {
  int best = 0;
  for (std::size_t k = 1; k < centres.size(); ++k) {
    if ((colour - centres[k]).squaredNorm() < (colour - centres[best]).squaredNorm()) best = static_cast<int>(k);
  }
  return best;
}

// K-means over every colour, without a histogram: the reference.
void PlainKMeans(const std::vector<Eigen::Vector3f>& colours, std::vector<Eigen::Vector3f>& centres) {
  for (int iteration = 0; iteration < 50; ++iteration) {
    std::vector<Eigen::Vector4d> sums(centres.size(), Eigen::Vector4d::Zero());
    for (const Eigen::Vector3f& colour : colours) {
      Eigen::Vector4d& sum = sums[Nearest(colour, centres)];
      sum.head<3>() += colour.cast<double>();
      sum[3] += 1;
    }
    for (std::size_t k = 0; k < centres.size(); ++k) {
      if (sums[k][3] > 0) centres[k] = (sums[k].head<3>() / sums[k][3]).cast<float>();
    }
  }
}

TEST(SegmentColours, TheHistogramGivesWhatPlainKMeansGives) {
  const std::vector<Eigen::Vector3f> deviations = Deviations(40000);
  const std::vector<std::uint8_t> used(deviations.size(), 1);
  const Segmentation found = SegmentColours(deviations, used, 1.2, {});
  ASSERT_GE(found.centres.size(), 2u);
  std::vector<Eigen::Vector3f> centres = found.centres;
  PlainKMeans(deviations, centres);
  for (std::size_t k = 0; k < centres.size(); ++k) EXPECT_LT((centres[k] - found.centres[k]).norm(), 0.1) << k;
  std::size_t same = 0;
  for (std::size_t i = 0; i < deviations.size(); ++i) {
    same += (Nearest(deviations[i], centres) != 0) == (found.class_of[i] != 0) ? 1 : 0;
  }
  EXPECT_GT(static_cast<double>(same), 0.999 * static_cast<double>(deviations.size()));
}

TEST(SegmentColours, LeavesOutWhatIsNotUsed) {
  const std::vector<Eigen::Vector3f> deviations = Deviations(4000);
  std::vector<std::uint8_t> used(deviations.size(), 1);
  for (std::size_t i = 0; i < used.size(); i += 40) used[i] = 0;  // the spots
  for (std::size_t i = 1; i < used.size(); i += 333) used[i] = 0;
  const Segmentation found = SegmentColours(deviations, used, 1.2, {});
  EXPECT_EQ(found.centres.size(), 1u);
  EXPECT_EQ(std::count(found.class_of.begin(), found.class_of.end(), 0), 4000);
}

FruitCloud SphereCloud(int points) {
  FruitCloud fruit;
  fruit.surface = FruitSurface({0, 0, 0}, CubeTable<float>::Of(8, [](const Eigen::Vector3d&) { return 18.0f; }));
  fruit.observed_share = 1;
  std::mt19937_64 random(2);
  std::normal_distribution<float> normal;
  for (int k = 0; k < points; ++k) {
    const Eigen::Vector3f d = Eigen::Vector3f(normal(random), normal(random), normal(random)).normalized();
    fruit.offsets.push_back(18 * d);
    fruit.colours.emplace_back(120, 140, 60);
    fruit.lab.push_back(Eigen::Vector3f(50 + 10 * d.z(), -20, 40));  // lit from above
  }
  return fruit;
}

TEST(SkinMap, CellsHaveTheSurfacesAreaAndTheirNeighboursBorderThem) {
  const FruitCloud fruit = SphereCloud(20000);
  const SkinMap map(fruit);
  double area = 0;
  for (int cell = 0; cell < map.size(); ++cell) {
    area += map.AreaOf(cell);
    const auto neighbours = map.NeighboursOf(cell);
    for (int k = 0; k < 8; ++k) {
      EXPECT_EQ(neighbours[k], map.map().Neighbour(cell, std::array{1, -1, 0, 0, 1, -1, 1, -1}[k],
                                                   std::array{0, 0, 1, -1, 1, 1, -1, -1}[k]));
    }
  }
  EXPECT_NEAR(area, 4 * 3.14159265 * 18 * 18, 1);
  EXPECT_NEAR(map.CellSize(), std::sqrt(area / map.size()), 1e-4);
}

TEST(MeasureDeviation, TakesTheShadingOff) {
  const FruitCloud fruit = SphereCloud(60000);
  const SkinMap map(fruit);
  const auto colours = MeasureDeviation(fruit, map, {});
  ASSERT_TRUE(colours.ok());
  double largest = 0;
  for (int cell = 0; cell < map.size(); ++cell) largest = std::max<double>(largest, colours->deviation[cell].norm());
  EXPECT_LT(largest, 1.0);  // of 10 that the shading makes
  EXPECT_LT(colours->sigma, 0.2);
}

/// Points of defects found and true, intersection over union; 0 when fewer than 201 are either.
double AgreementOfPoints(const FruitCloud& fruit, const std::vector<std::uint8_t>& truth) {
  const SkinMap map(fruit);
  const auto colours = MeasureDeviation(fruit, map, {});
  if (!colours.ok()) return 0;
  const Segmentation segmentation = SegmentColours(colours->deviation, colours->seen, colours->sigma, {});
  const std::vector<std::uint8_t> classes = ClassifyPoints(fruit, map, *colours, segmentation, {});
  double both = 0, either = 0;
  for (std::size_t i = 0; i < fruit.size(); ++i) {
    both += truth[i] != 0 && classes[i] != 0 ? 1 : 0;
    either += truth[i] != 0 || classes[i] != 0 ? 1 : 0;
  }
  return either > 200 ? both / either : 0;
}

TEST(ClassifyPoints, EndsADefectWhereThePointsColourDoes) {
  FruitCloud fruit = SphereCloud(100000);
  const Eigen::Vector3f middle = Eigen::Vector3f(1, 0.3f, 0.2f).normalized();
  std::vector<std::uint8_t> truth;
  for (std::size_t i = 0; i < fruit.size(); ++i) {
    truth.push_back(fruit.offsets[i].normalized().dot(middle) > std::cos(0.1f) ? 1 : 0);
    if (truth[i] != 0) fruit.lab[i] += Eigen::Vector3f(-18, 12, -15);
  }
  EXPECT_GT(AgreementOfPoints(fruit, truth), 0.99);
}

// A spot whose colour fades out over 0.6 mm ends half way all the same, and a speck is no defect.
TEST(ClassifyPoints, EndsASoftSpotHalfWayAndLeavesSpecksOut) {
  FruitCloud fruit = SphereCloud(400000);
  const Eigen::Vector3f middle = Eigen::Vector3f(1, 0.3f, 0.2f).normalized();
  const Eigen::Vector3f speck = Eigen::Vector3f(-1, 0.3f, 0.2f).normalized();
  std::vector<std::uint8_t> truth;
  for (std::size_t i = 0; i < fruit.size(); ++i) {
    const Eigen::Vector3f d = fruit.offsets[i].normalized();
    const float away = 18 * std::acos(std::clamp(d.dot(middle), -1.0f, 1.0f));
    truth.push_back(away < 1 ? 1 : 0);
    float share = std::clamp(0.5f + (1 - away) / 0.6f, 0.0f, 1.0f);
    if (18 * std::acos(std::clamp(d.dot(speck), -1.0f, 1.0f)) < 0.25f) share = 1;
    const Eigen::Array3f skin(120, 140, 60), spot(110, 95, 60);
    const Eigen::Array3f mixed = ((1 - share) * skin.pow(2.2f) + share * spot.pow(2.2f)).pow(1 / 2.2f);
    fruit.colours[i] = (mixed + 0.5f).cast<std::uint8_t>();
    fruit.lab[i] = LabFromSrgb(fruit.colours[i]);
  }
  EXPECT_GT(AgreementOfPoints(fruit, truth), 0.97);
}

}  // namespace
}  // namespace drupe
