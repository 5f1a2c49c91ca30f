#include "scene/random_skin.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <iterator>

#include "image/colour.h"

namespace drupe {
namespace {

using std::numbers::pi;
constexpr double kLeastContrast = 14;  // Lab units with L halved: what a grader sees at a glance
constexpr double kOffSkinShare = 0.3;  // of the rain spots: bleached skin, or skin of another hue
constexpr int kTrials = 40;

Eigen::Vector3d LinearOf(const Eigen::Vector3d& srgb) {
  return (srgb / 255).array().pow(2.2);
}

double Contrast(const Eigen::Vector3d& a, const Eigen::Vector3d& b) {
  Eigen::Vector3f difference = LabFromLinear(a.cast<float>()) - LabFromLinear(b.cast<float>());
  difference[0] *= 0.5f;
  return difference.norm();
}

// sRGB of a defect's own colour.
Eigen::Vector3d DrawPigment(Dice& dice, DefectClass defect_class) {
  const double shade = dice.Uniform(0.85, 1.15);
  switch (defect_class) {
    case DefectClass::kCrack:
      return shade * Eigen::Vector3d(62, 52, 42);
    case DefectClass::kDecay:
      return shade * Eigen::Vector3d(92, 70, 48);
    case DefectClass::kScar:
      return shade * Eigen::Vector3d(164, 138, 100);
    default:
      break;
  }
  const int kind = dice.Below(5);
  if (kind == 3) return shade * Eigen::Vector3d(178, 160, 128);  // pale, corky
  if (kind == 4) return shade * Eigen::Vector3d(64, 52, 44);     // dark
  return shade * Eigen::Vector3d(112, 92, 68);                   // light brown
}

// The skin's own colour, bleached, or as light as before in another hue; linear light.
Eigen::Vector3d DrawOffSkin(Dice& dice, const Eigen::Vector3d& skin) {
  const Eigen::Vector3d luminance(0.2127, 0.7152, 0.0722);
  const double white = dice.Uniform(0.35, 0.6);
  if (dice.Chance(0.5)) return (1 - white) * skin + white * Eigen::Vector3d(0.75, 0.72, 0.62);
  const Eigen::Vector3d hues[] = {LinearOf({190, 60, 50}), LinearOf({60, 150, 60}), LinearOf({200, 150, 20})};
  const Eigen::Vector3d& hue = hues[dice.Below(3)];
  return hue * std::min(skin.dot(luminance) / hue.dot(luminance), 0.95 / hue.maxCoeff());
}

void DrawOutline(Dice& dice, SkinShape& shape) {
  const auto draw = [&](double area, double stretch, double lobe, double soft) {
    shape.radius_mm = std::sqrt(area / pi);
    shape.stretch = stretch;
    shape.soft_mm = soft;
    for (int k = 0; k < 4; ++k) {
      shape.lobes[k] = lobe * dice.Uniform(0, 1) / (1 + k);
      shape.phases[k] = dice.Uniform(0, 2 * pi);
    }
  };
  switch (shape.defect_class) {
    case DefectClass::kCrack:
      draw(dice.Uniform(1.8, 5), dice.Uniform(10, 20), 0, dice.Uniform(0.02, 0.06));
      shape.bend = dice.Uniform(-0.03, 0.03);
      shape.depth_mm = dice.Uniform(0.02, 0.3);
      return;
    case DefectClass::kScar:
      draw(dice.Uniform(6, 18), dice.Uniform(4, 6.5), 0.02, dice.Uniform(0.05, 0.15));
      shape.bend = dice.Uniform(-0.03, 0.03);
      return;
    case DefectClass::kDecay:
      draw(dice.Uniform(28, 80), dice.Uniform(1, 1.4), 0.12, dice.Uniform(0.1, 0.3));
      shape.depth_mm = dice.Uniform(0, 0.3);
      return;
    default:
      draw(dice.Uniform(1, 7.5), dice.Uniform(1, 1.25), 0.05, dice.Uniform(0.05, 0.15));
      shape.depth_mm = dice.Uniform(0, 0.03);
  }
}

}  // namespace

SmoothNoise::SmoothNoise(Dice& dice, double waves, int cells) {
  constexpr int kWaves = 12;
  std::array<Eigen::Vector3d, kWaves> vectors;
  std::array<double, kWaves> phases;
  for (int k = 0; k < kWaves; ++k) {
    vectors[k] = waves * dice.Uniform(0.5, 1.2) * dice.Direction();
    phases[k] = dice.Uniform(0, 2 * pi);
  }
  table_ = CubeTable<float>::Of(cells, [&](const Eigen::Vector3d& direction) {
    double sum = 0;
    for (int k = 0; k < kWaves; ++k) sum += std::sin(vectors[k].dot(direction) + phases[k]);
    return static_cast<float>(sum * std::sqrt(2.0 / kWaves));
  });
}

double SkinShape::InsideBy(const Eigen::Vector3d& direction, double scale) const {
  const double cosine = std::clamp(direction.dot(axis), -1.0, 1.0);
  if (scale * (1 - cosine) > 1.5 * Reach() + 1) return -scale;
  const double arc = scale * std::acos(cosine);
  if (arc > 1.5 * Reach() + 1) return -arc;
  const double side = std::max(1e-12, std::sqrt(1 - cosine * cosine));
  double x = arc * direction.dot(right) / side, y = arc * direction.dot(down) / side;
  y -= bend * x * x;
  const double root = std::sqrt(stretch);
  const double edge = EdgeAt(std::atan2(y * root, x / root));
  // Distance to an ellipse by its first-order estimate, which is exact for a circle.
  const double u = x / (radius_mm * root), v = y * root / radius_mm;
  const double level = std::hypot(u, v);
  const double slope = std::hypot(u / (radius_mm * root), v * root / radius_mm) / std::max(1e-9, level);
  return (edge - level) / std::max(1e-9, slope);
}

double SkinShape::EdgeAt(double angle) const {
  double edge = 1;
  for (int k = 0; k < 4; ++k) edge += lobes[k] * std::cos((k + 2) * angle + phases[k]);
  return edge;
}

Eigen::Vector2d SkinShape::OutlineAt(double angle) const {
  const double root = std::sqrt(stretch), edge = radius_mm * EdgeAt(angle);
  const double x = edge * root * std::cos(angle);
  return {x, edge / root * std::sin(angle) + bend * x * x};
}

double SkinShape::Reach() const {
  return 1.3 * radius_mm * std::sqrt(stretch);
}

SkinShape DrawShape(Dice& dice, DefectClass defect_class, const Eigen::Vector3d& skin, const Eigen::Vector3d& axis) {
  SkinShape shape;
  shape.defect_class = defect_class;
  shape.axis = axis;
  const Eigen::AngleAxisd turn(dice.Uniform(0, pi), axis);
  shape.right = turn * axis.unitOrthogonal();
  shape.down = axis.cross(shape.right);
  DrawOutline(dice, shape);
  const bool off_skin = defect_class == DefectClass::kRainSpot && dice.Chance(kOffSkinShare);
  for (int trial = 0; trial < kTrials; ++trial) {
    const Eigen::Vector3d pigment = DrawPigment(dice, defect_class);
    shape.cover = defect_class == DefectClass::kRainSpot ? dice.Uniform(0.7, 1) : 1;
    shape.linear = off_skin ? DrawOffSkin(dice, skin) : LinearOf(pigment);
    if (Contrast(shape.ColourOn(skin), skin) > kLeastContrast) return shape;
  }
  // Dark skin under dark pigment: it has come off, and pale flesh shows.
  shape.linear = LinearOf({214, 196, 160});
  if (defect_class == DefectClass::kCrack) shape.depth_mm = dice.Uniform(0.2, 0.35);
  return shape;
}

Eigen::Vector3d DrawSkinColour(Dice& dice) {
  // sRGB of yellow, red, purple, brown, dark, grey and pale fruit, and of green fruit twice.
  static const Eigen::Vector3d kColours[] = {{200, 168, 66},  {166, 52, 48},  {92, 56, 88},
                                             {124, 92, 58},   {58, 50, 60},   {138, 136, 130},
                                             {206, 200, 150}, {134, 154, 66}, {134, 154, 66}};
  const double shade = dice.Uniform(0.9, 1.1);
  return LinearOf(shade * kColours[dice.Below(static_cast<int>(std::size(kColours)))]);
}

}  // namespace drupe
