#include "defect_analysis/fruit/foreign_colours.h"

#include <algorithm>

namespace drupe {
namespace {

constexpr double kCertainSigma = 2;
constexpr std::size_t kCertainSample = 20'000;

std::vector<float> HeightsAbove(const FruitCloud& fruit) {
  std::vector<float> heights;
  heights.reserve(fruit.size());
  for (const Eigen::Vector3f& offset : fruit.offsets) {
    heights.push_back(offset.norm() - fruit.surface.RadiusAt(offset));
  }
  return heights;
}

double ShareTakenForFruit(const ColourClassifier& classifier, const FruitCloud& fruit,
                          const std::vector<float>& heights) {
  const std::size_t step = std::max<std::size_t>(1, fruit.size() / kCertainSample);
  std::vector<Rgb8> certain;
  for (std::size_t i = 0; i < fruit.size(); i += step) {
    if (std::abs(heights[i]) <= kCertainSigma * fruit.noise_mm) certain.push_back(fruit.colours[i]);
  }
  if (certain.empty()) return 0;
  const std::vector<float> decisions = classifier.Decide(certain);
  const auto known = std::count_if(decisions.begin(), decisions.end(), [](float decision) { return decision > 0; });
  return static_cast<double>(known) / static_cast<double>(certain.size());
}

}  // namespace

ForeignColours RemoveForeignColours(const ColourClassifier& classifier, const BackgroundOptions& options,
                                    FruitCloud& fruit) {
  const std::vector<float> heights = HeightsAbove(fruit);
  ForeignColours result;
  result.known_share = ShareTakenForFruit(classifier, fruit, heights);
  result.known = result.known_share >= options.known_share;
  if (!result.known) return result;
  std::vector<Rgb8> doubtful;
  const double doubt = std::max(options.doubt_mm, options.doubt_sigma * fruit.noise_mm);
  const auto in_doubt = [&](std::size_t i) { return heights[i] > doubt; };
  for (std::size_t i = 0; i < fruit.size(); ++i) {
    if (in_doubt(i)) doubtful.push_back(fruit.colours[i]);
  }
  const std::vector<float> decisions = classifier.Decide(doubtful);
  std::size_t kept = 0, next = 0;
  for (std::size_t i = 0; i < heights.size(); ++i) {
    if (in_doubt(i) && decisions[next++] <= 0) continue;
    fruit.offsets[kept] = fruit.offsets[i];
    fruit.colours[kept] = fruit.colours[i];
    fruit.lab[kept++] = fruit.lab[i];
  }
  result.removed = heights.size() - kept;
  fruit.offsets.resize(kept);
  fruit.colours.resize(kept);
  fruit.lab.resize(kept);
  return result;
}

PointCloud KeepFruitColours(const ColourClassifier& classifier, const PointCloud& cloud) {
  const std::vector<float> decisions = classifier.Decide(cloud.colours);
  PointCloud kept;
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    if (decisions[i] <= 0) continue;
    kept.positions.push_back(cloud.positions[i]);
    kept.colours.push_back(cloud.colours[i]);
  }
  return kept;
}

}  // namespace drupe
