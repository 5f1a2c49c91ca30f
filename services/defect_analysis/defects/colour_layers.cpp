#include "defect_analysis/defects/colour_layers.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>

#include "geometry/robust.h"
#include "image/colour.h"

namespace drupe {
namespace {

constexpr float kLeastAngle = 0.15f;     // distance of the second colour from the first's line, over that along it
constexpr float kLeastAlong = 0.25f;     // of the first's length: how much of it shade may hide in any colour
constexpr float kLeastNoise = 4;         // the same in standard deviations of a node
constexpr float kPure = 0.75f;           // share from which a node tells a corner's colour
constexpr double kStrongestArea = 0.12;  // mm2 of the strongest nodes that give the first corner
constexpr double kStrongestShare = 0.03;
constexpr float kOnLine = 1e-3f;    // of the first colour: how far off its line a fainter one of it lies
constexpr float kOpposite = -0.3f;  // cosine between two changes
constexpr int kRefinements = 3;
constexpr double kThinStrip = 0.16;  // mm: half width below which a strip of the second colour is none
constexpr int kZoneMargin = 3;       // nodes about the second colour where both share a node
constexpr float kFainterFrom = 0.25f, kFainterTo = 0.8f;  // of the first colour, in which a fainter one is sought
constexpr float kEven = 0.1f;                             // of the first colour, about the fainter one's middle
constexpr double kFainterCore = 0.3;                      // of the least area, of it clear of rims
constexpr double kEvenShare = 0.8;                        // of what lies between, that is so even
constexpr float kKernelNoise = 0.4f;  // of a node against a point: the kernel averages about six of them

// The three corners, skin at zero, in units of the skin's noise in each channel.
class Triangle {
 public:
  Triangle(const Eigen::Vector3f& first, const Eigen::Vector3f& second) {
    // A fainter first colour spans none either: what is stronger than that is some first colour on it.
    const float part = first.dot(second) / first.squaredNorm();
    if ((second - part * first).norm() < kOnLine * first.norm()) {
      fainter_ = part;
      inverse_ << first.transpose() / first.squaredNorm(), second.transpose() / second.squaredNorm();
      return;
    }
    Eigen::Matrix<float, 3, 2> corners;
    corners << first, second;
    // Opposite changes, one paler and one darker than the skin, span no triangle: each is told by its own direction.
    if (first.dot(second) < kOpposite * first.norm() * second.norm()) {
      inverse_ << first.transpose() / first.squaredNorm(), second.transpose() / second.squaredNorm();
      return;
    }
    inverse_ = (corners.transpose() * corners).inverse() * corners.transpose();
  }
  Eigen::Vector2f SharesOf(const Eigen::Vector3f& change) const {
    const Eigen::Vector2f shares = inverse_ * change;
    if (fainter_ == 0) return shares;
    const float first = std::max(0.0f, (shares[0] - fainter_) / (1 - fainter_));
    return {first, first > 0 ? 1 - first : shares[1]};
  }
  /// Standard deviation of a share for noise of 1 in each channel.
  float NoiseOf(int corner) const { return inverse_.row(corner).norm() / (corner == 0 ? 1 - fainter_ : 1); }

 private:
  Eigen::Matrix<float, 2, 3> inverse_;
  float fainter_ = 0;  // of the first colour, the second; 0: the second is no fainter first one
};

Eigen::Vector3f MedianOf(const std::vector<Eigen::Vector3f>& values) {
  Eigen::Vector3f median;
  for (int c = 0; c < 3; ++c) {
    std::vector<float> channel;
    for (const Eigen::Vector3f& value : values) channel.push_back(value[c]);
    median[c] = Median(std::move(channel));
  }
  return median;
}

// Part of a colour off the line from the skin to `first`.
Eigen::Vector3f OffLine(const Eigen::Vector3f& colour, const Eigen::Vector3f& first) {
  const float along = std::clamp(colour.dot(first) / first.squaredNorm(), 0.0f, 1.3f);
  return colour - along * first;
}

// How far off the first colour's line noise and shading carry what is a share of it, which they do by that share.
float LimitOf(const Eigen::Vector3f& colour, const Eigen::Vector3f& first) {
  const float along = std::clamp(colour.dot(first) / first.squaredNorm(), kLeastAlong, 1.0f);
  return std::max(kLeastNoise * kKernelNoise, kLeastAngle * along * first.norm());
}

class Separation {
 public:
  Separation(const TransitionField& field, double level) : field_(field) {
    for (std::size_t node = 0; node < field.level.size(); ++node) {
      if (field.level[node] < level && field.inside[node] <= 0) continue;
      nodes_.push_back(node);
      colours_.push_back(field.change[node].cwiseQuotient(field.change_noise));
    }
  }

  // Finds the corners; false when one colour explains the patch.
  bool Find(double min_area) {
    const double node_area = field_.step * field_.step;
    if (static_cast<double>(nodes_.size()) * node_area < 2 * min_area) return false;
    first_ = StrongestColour(node_area);
    return FindOffLine() || FindFainter(min_area);
  }

  // Distance in Lab of the second colour from the best mixture of the first and skin, or the reverse if less.
  double Contrast(double lightness_weight) const {
    if (fainter_) return LabBetween(LabFromLinear(LinearOf(first_)), second_, lightness_weight);
    return std::min(LabOffLine(second_, first_, lightness_weight), LabOffLine(first_, second_, lightness_weight));
  }

  std::vector<ColourLayer> Layers() const {
    const Triangle triangle(first_, second_);
    std::vector<ColourLayer> layers = {LayerOf(first_, triangle.NoiseOf(0)), LayerOf(second_, triangle.NoiseOf(1))};
    const std::size_t nodes = field_.level.size();
    std::vector<Eigen::Vector2f> shares(nodes);
    std::vector<std::uint8_t> mostly_second(nodes);
    for (std::size_t node = 0; node < nodes; ++node) {
      shares[node] = triangle.SharesOf(field_.change[node].cwiseQuotient(field_.change_noise));
      mostly_second[node] = shares[node][1] >= 0.5f ? 1 : 0;
    }
    const std::vector<std::uint8_t> core = Eroded(std::move(mostly_second));
    const std::vector<std::uint8_t> zone = Grown(core, ThinSteps() + kZoneMargin);
    const std::vector<std::uint8_t> reach = Grown(core, 2 * ThinSteps() + kZoneMargin);
    const std::vector<std::uint8_t> rim = Grown(MostlyFirst(zone), ThinSteps());
    for (std::size_t node = 0; node < nodes; ++node) {
      const float first = zone[node] != 0 ? shares[node][0] : AlongOnly(node, first_);
      // Clear of the first colour, the second's share is told as if there were no other, which is not so noisy.
      float second = zone[node] != 0 ? shares[node][1] : 0.0f;
      if (reach[node] != 0 && rim[node] == 0) second = AlongOnly(node, second_);
      layers[0].field.level[node] = layers[0].field.full_level[node] = std::clamp(first, -0.5f, 1.5f);
      layers[1].field.level[node] = layers[1].field.full_level[node] = std::clamp(second, -0.5f, 1.5f);
      layers[0].other[node] = layers[1].field.level[node];
      layers[1].other[node] = rim[node] != 0 ? 1.0f : 0.0f;
    }
    return layers;
  }

 private:
  // A second colour off the first's line.
  bool FindOffLine() {
    const std::vector<std::uint8_t> wide = WideOffLine();
    std::vector<std::pair<float, std::size_t>> off;
    for (std::size_t i = 0; i < colours_.size(); ++i) {
      if (wide[nodes_[i]] != 0) off.emplace_back(-OffLine(colours_[i], first_).norm(), i);
    }
    if (off.size() < 3) return false;
    std::sort(off.begin(), off.end());
    off.resize(std::max<std::size_t>(3, off.size() / 2));
    std::vector<Eigen::Vector3f> farthest;
    for (const auto& [distance, i] : off) farthest.push_back(colours_[i]);
    second_ = MedianOf(farthest);
    for (int k = 0; k < kRefinements; ++k) Refine();
    return OffLine(second_, first_).norm() > LimitOf(second_, first_) &&
           OffLine(first_, second_).norm() > LimitOf(first_, first_);
  }

  // A second colour on that line: even, fainter than the first, and away from rims, where each share occurs.
  bool FindFainter(double min_area) {
    std::vector<std::uint8_t> between(field_.level.size(), 0);
    for (const std::size_t node : nodes_) {
      const float along = AlongOnly(node, first_);
      between[node] = along > kFainterFrom && along < kFainterTo ? 1 : 0;
    }
    between = Eroded(std::move(between));
    std::vector<float> parts;
    for (std::size_t node = 0; node < between.size(); ++node) {
      if (between[node] != 0) parts.push_back(AlongOnly(node, first_));
    }
    if (static_cast<double>(parts.size()) * field_.step * field_.step < kFainterCore * min_area) return false;
    const float part = Median(parts);
    const auto even = std::count_if(parts.begin(), parts.end(), [&](float p) { return std::abs(p - part) < kEven; });
    if (static_cast<double>(even) < kEvenShare * static_cast<double>(parts.size())) return false;
    second_ = part * first_;
    fainter_ = true;
    return (first_ - second_).norm() > kLeastNoise * kKernelNoise;
  }

  int ThinSteps() const { return std::max(2, static_cast<int>(std::lround(kThinStrip / field_.step))); }

  // What is left of a mask when strips up to twice kThinStrip wide, and as much of every rim, are taken off. Along a
  // dark rim the hue is another because a picture's colour is blurred more than its brightness (chroma is stored at
  // half the resolution).
  std::vector<std::uint8_t> Eroded(std::vector<std::uint8_t> mask) const {
    for (std::uint8_t& m : mask) m = m == 0 ? 1 : 0;
    mask = Grown(std::move(mask), ThinSteps());
    for (std::uint8_t& m : mask) m = m == 0 ? 1 : 0;
    return mask;
  }

  // Nodes of the patch well off the first colour's line, away from rims.
  std::vector<std::uint8_t> WideOffLine() const {
    std::vector<std::uint8_t> mask(field_.level.size(), 0);
    for (std::size_t i = 0; i < nodes_.size(); ++i)
      mask[nodes_[i]] = OffLine(colours_[i], first_).norm() > LimitOf(colours_[i], first_) ? 1 : 0;
    return Eroded(std::move(mask));
  }

  float AlongOnly(std::size_t node, const Eigen::Vector3f& corner) const {
    return field_.change[node].cwiseQuotient(field_.change_noise).dot(corner) / corner.squaredNorm();
  }

  // Nodes that the first colour covers by more than the second would seem to, and that are not the second's own.
  std::vector<std::uint8_t> MostlyFirst(const std::vector<std::uint8_t>& zone) const {
    const Triangle triangle(first_, second_);
    const float seeming = std::max(0.5f, second_.dot(first_) / first_.squaredNorm() + 0.15f);
    std::vector<std::uint8_t> mask(field_.level.size(), 0);
    for (std::size_t node = 0; node < mask.size(); ++node) {
      const Eigen::Vector3f colour = field_.change[node].cwiseQuotient(field_.change_noise);
      const bool covered = zone[node] != 0 ? triangle.SharesOf(colour)[0] >= 0.5f : AlongOnly(node, first_) >= seeming;
      mask[node] = covered ? 1 : 0;
    }
    return mask;
  }

  // Grows a mask by so many steps, over edges and corners in turn, which makes octagons.
  std::vector<std::uint8_t> Grown(std::vector<std::uint8_t> mask, int steps) const {
    for (int step = 0; step < steps; ++step) {
      const std::vector<std::uint8_t> before = mask;
      for (int row = 1; row + 1 < field_.height; ++row) {
        for (int column = 1; column + 1 < field_.width; ++column) {
          const std::uint8_t* m = &before[static_cast<std::size_t>(row) * field_.width + column];
          const int w = field_.width;
          bool any = (m[-1] | m[1] | m[-w] | m[w]) != 0;
          if (step % 2 != 0) any = any || (m[-w - 1] | m[-w + 1] | m[w - 1] | m[w + 1]) != 0;
          if (any) mask[static_cast<std::size_t>(row) * w + column] = 1;
        }
      }
    }
    return mask;
  }

  Eigen::Vector3f StrongestColour(double node_area) const {
    std::vector<std::pair<float, std::size_t>> strength;
    for (std::size_t i = 0; i < colours_.size(); ++i) strength.emplace_back(-colours_[i].norm(), i);
    std::sort(strength.begin(), strength.end());
    const auto wanted = static_cast<std::size_t>(
        std::max({3.0, kStrongestArea / node_area, kStrongestShare * static_cast<double>(colours_.size())}));
    strength.resize(std::min(strength.size(), wanted));
    std::vector<Eigen::Vector3f> strongest;
    for (const auto& [value, i] : strength) strongest.push_back(colours_[i]);
    return MedianOf(strongest);
  }

  // Moves each corner to the median of the nodes that are nearly pure.
  void Refine() {
    const Triangle triangle(first_, second_);
    std::vector<Eigen::Vector3f> pure[2];
    for (const Eigen::Vector3f& colour : colours_) {
      const Eigen::Vector2f shares = triangle.SharesOf(colour);
      for (int k = 0; k < 2; ++k) {
        if (shares[k] > kPure && std::abs(shares[1 - k]) < 1 - kPure) pure[k].push_back(colour);
      }
    }
    if (pure[0].size() >= 3) first_ = MedianOf(pure[0]);
    if (pure[1].size() >= 3) second_ = MedianOf(pure[1]);
  }

  Eigen::Vector3f LinearOf(const Eigen::Vector3f& colour) const {
    const Eigen::Vector3f ratio = colour.cwiseProduct(field_.change_noise).array() + 1;
    return ratio.cwiseMax(0.0f).cwiseProduct(field_.healthy_linear.cast<float>());
  }

  double LabOffLine(const Eigen::Vector3f& colour, const Eigen::Vector3f& line, double lightness_weight) const {
    const Eigen::Vector3f lab = LabFromLinear(LinearOf(colour));
    float nearest = 1e9f;
    for (float along = 0; along <= 1.3f; along += 0.05f) {
      nearest = std::min(nearest, LabBetween(lab, along * line, lightness_weight));
    }
    return nearest;
  }

  float LabBetween(const Eigen::Vector3f& lab, const Eigen::Vector3f& colour, double lightness_weight) const {
    Eigen::Vector3f difference = lab - LabFromLinear(LinearOf(colour));
    difference[0] *= static_cast<float>(lightness_weight);
    return difference.norm();
  }

  ColourLayer LayerOf(const Eigen::Vector3f& colour, float noise) const {
    ColourLayer layer{.field = field_, .other = std::vector<float>(field_.level.size(), 0)};
    layer.field.noise = noise;
    layer.field.defect_linear = LinearOf(colour).cast<double>();
    layer.field.defect_lab = LabFromLinear(LinearOf(colour)).cast<double>();
    return layer;
  }

  const TransitionField& field_;
  std::vector<std::size_t> nodes_;
  std::vector<Eigen::Vector3f> colours_;
  Eigen::Vector3f first_ = Eigen::Vector3f::Zero(), second_ = Eigen::Vector3f::Zero();
  bool fainter_ = false;  // the second is a fainter first one
};

}  // namespace

std::vector<ColourLayer> SeparateColours(const TransitionField& field, double level, double min_area,
                                         double least_contrast, double lightness_weight) {
  Separation separation(field, level);
  if (!separation.Find(min_area) || separation.Contrast(lightness_weight) < least_contrast) return {};
  return separation.Layers();
}

}  // namespace drupe
