#include "defect_analysis/models/colour_sample.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <numbers>

namespace drupe {
namespace {

constexpr int kRegionBits = 4;  // of a channel
constexpr std::array<double, 3> kGains = {1.0, 0.45, 1.5};

int RegionOf(const Rgb8& colour) {
  int region = 0;
  for (int channel = 0; channel < 3; ++channel) region = region << kRegionBits | colour[channel] >> (8 - kRegionBits);
  return region;
}

std::map<int, std::vector<Rgb8>> Regions(const LabelledColours& from, std::uint8_t label) {
  std::map<int, std::vector<Rgb8>> regions;
  for (std::size_t i = 0; i < from.size(); ++i) {
    if (from.is_fruit[i] == label) regions[RegionOf(from.colours[i])].push_back(from.colours[i]);
  }
  return regions;
}

void SampleClass(const LabelledColours& from, std::uint8_t label, int count, LabelledColours& to) {
  const std::map<int, std::vector<Rgb8>> regions = Regions(from, label);
  double roots = 0;
  for (const auto& [region, colours] : regions) roots += std::sqrt(static_cast<double>(colours.size()));
  for (const auto& [region, colours] : regions) {
    const double share = std::sqrt(static_cast<double>(colours.size())) / roots;
    const std::size_t quota = std::clamp<std::size_t>(static_cast<std::size_t>(share * count), 1, colours.size());
    for (std::size_t k = 0; k < quota; ++k) to.Add(colours[k * colours.size() / quota], label != 0);
  }
}

}  // namespace

LabelledColours SampleColours(const LabelledColours& from, int per_class) {
  LabelledColours sample;
  for (const std::uint8_t label : {0, 1}) SampleClass(from, label, per_class, sample);
  return sample;
}

Rgb8 Recolour(const Rgb8& colour, double turn_deg, double gain) {
  const Eigen::AngleAxisd turn(turn_deg * std::numbers::pi / 180, Eigen::Vector3d::Ones().normalized());
  const Eigen::Array3d turned = gain * (turn * colour.cast<double>()).array();
  return (turned.max(0.0).min(255.0) + 0.5).cast<std::uint8_t>().matrix();
}

LabelledColours WithRecolouredFruit(const LabelledColours& from, int copies) {
  LabelledColours all = from;
  for (int copy = 1; copy <= copies; ++copy) {
    for (std::size_t i = 0; i < from.size(); ++i) {
      if (from.is_fruit[i] == 0) continue;
      all.Add(Recolour(from.colours[i], 360.0 * copy / (copies + 1), kGains[copy % kGains.size()]), true);
    }
  }
  return all;
}

void SplitOff(double share, LabelledColours& kept, LabelledColours& split) {
  if (share <= 0) return;
  const auto every = static_cast<std::size_t>(std::lround(1 / share));
  const LabelledColours all = std::move(kept);
  kept = {};
  std::array<std::size_t, 2> seen = {0, 0};
  for (std::size_t i = 0; i < all.size(); ++i) {
    const bool fruit = all.is_fruit[i] != 0;
    (++seen[fruit ? 1 : 0] % std::max<std::size_t>(2, every) == 0 ? split : kept).Add(all.colours[i], fruit);
  }
}

}  // namespace drupe
