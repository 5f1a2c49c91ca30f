#include "scene/random_fruit.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "image/colour.h"
#include "scene/fruit_cloud.h"
#include "scene/random_skin.h"
#include "scene/synthetic_fruit.h"

namespace drupe {
namespace {

using std::numbers::pi;
constexpr double kLens = 0.07;         // mm: half width that the pictures' own blur gives an edge
constexpr double kApart = 0.7;         // mm of skin between defects that do not touch
constexpr double kMostCovered = 0.25;  // of a defect's area by another one
constexpr double kMostUnseen = 0.1;    // of a defect's area by a gap
constexpr int kTruthCells = 96;
constexpr int kViews = 36;

struct Gap {
  Eigen::Vector3d axis, right, down;
  double half_width_mm, half_height_mm;
};

struct Lobe {
  Eigen::Vector3d axis;
  double width;
  double strength;
};

// Everything that is drawn before the points are.
class FruitDrawing {
 public:
  FruitDrawing(std::uint64_t seed, const RandomFruitOptions& options)
      : dice_(seed),
        options_(options),
        bumps_(dice_, 2.2, 24),
        mottle_(dice_, 6, 48),
        blush_(dice_, 1.6, 24),
        light_(dice_, 1.3, 24),
        freckles_(dice_, 70, 160),
        place_error_(dice_, 45, 120),
        seam_(dice_, 9, 48) {
    DrawBody();
    DrawLight();
    DrawDefects();
    DrawGaps();
  }

  RandomFruit Sample() {
    RandomFruit fruit;
    fruit.truth = Truth();
    SyntheticFruit::AddBoardAndNeedle(centre_, fruit.cloud);
    const double area = fruit.truth.surface_area_mm2;
    const int turns = static_cast<int>(area / (options_.spacing_mm * options_.spacing_mm));
    for (int k = 0; k < turns; ++k) {
      const double z = 1 - (2.0 * k + 1) / turns, ring = std::sqrt(1 - z * z);
      const double azimuth = 2 * pi * std::numbers::phi * k;
      const Eigen::Vector3d even(ring * std::cos(azimuth), ring * std::sin(azimuth), z);
      const Eigen::Vector3d d = (even + 0.25 * options_.spacing_mm / scale_ * dice_.Direction()).normalized();
      if (IsSeen(d)) AddPoint(d, fruit.cloud);
    }
    return fruit;
  }

 private:
  void DrawBody() {
    equatorial_ = dice_.Uniform(12, 21);
    polar_ = equatorial_ * dice_.Uniform(0.86, 1.12);
    oval_ = dice_.Uniform(0, 0.02);
    hollow_ = dice_.Uniform(0, 0.06);
    suture_ = dice_.Uniform(0, 0.02);
    azimuth_ = dice_.Uniform(0, 2 * pi);
    centre_ = {dice_.Uniform(-1, 1), dice_.Uniform(-1, 1), 18 + polar_};
    scale_ = std::cbrt(equatorial_ * equatorial_ * polar_);
    skin_ = DrawSkinColour(dice_);
    blush_share_ = dice_.Chance(0.3) ? dice_.Uniform(0.2, 0.6) : 0;
    mottle_strength_ = dice_.Uniform(0.05, 0.14);
    surface_ = FruitSurface(centre_, CubeTable<float>::Of(kTruthCells, [&](const Eigen::Vector3d& d) {
                              return static_cast<float>(RadiusAt(d));
                            }));
  }

  void DrawLight() {
    for (int k = dice_.Below(4); k > 0; --k) {
      lobes_.push_back({dice_.Direction(), dice_.Uniform(0.1, 0.3), dice_.Uniform(0.01, 0.06)});
    }
    tinted_ = dice_.Chance(0.2);
    tint_axis_ = Eigen::Vector3d(std::cos(azimuth_), std::sin(azimuth_), -0.3).normalized();
    hidden_side_ = dice_.Chance(0.2);
    hidden_axis_ = Eigen::Vector3d(-std::sin(azimuth_), std::cos(azimuth_), -0.5).normalized();
    for (double& gain : view_gains_) gain = 1 + 0.015 * dice_.Normal();
    for (double& offset : view_offsets_) offset = 0.008 * dice_.Normal();
    noise_ = dice_.Uniform(0.8, 2.2);
    place_noise_ = dice_.Uniform(0.006, 0.02);
  }

  double RadiusAt(const Eigen::Vector3d& d) const {
    const double across = (d.x() * d.x() + d.y() * d.y()) / (equatorial_ * equatorial_);
    const double ellipsoid = 1 / std::sqrt(across + d.z() * d.z() / (polar_ * polar_));
    const double stalk = hollow_ * std::exp(-std::pow(std::acos(std::clamp(d.z(), -1.0, 1.0)) / 0.3, 2));
    const double away = std::remainder(std::atan2(d.y(), d.x()) - azimuth_, 2 * pi) * std::hypot(d.x(), d.y());
    const double groove = suture_ * std::exp(-std::pow(away / 0.12, 2));
    const double oval = 1 + oval_ * std::cos(2 * (std::atan2(d.y(), d.x()) - azimuth_)) * (1 - d.z() * d.z());
    return ellipsoid * oval * (1 + 0.004 * bumps_.At(d) - stalk - groove);
  }

  bool IsSeen(const Eigen::Vector3d& d) const {
    if (d.z() < -0.62 + 0.04 * seam_.At(d)) return false;
    if (hidden_side_ && d.dot(hidden_axis_) > 0.82) return false;
    return std::none_of(gaps_.begin(), gaps_.end(), [&](const Gap& gap) { return IsIn(gap, d); });
  }

  bool IsIn(const Gap& gap, const Eigen::Vector3d& d) const {
    if (d.dot(gap.axis) < 0.8) return false;
    const double x = scale_ * d.dot(gap.right) / gap.half_width_mm, y = scale_ * d.dot(gap.down) / gap.half_height_mm;
    return x * x + y * y < 1;
  }

  // Calls `visit(direction, area)` for small pieces of skin inside the shape's outline.
  template <typename Visit>
  void VisitInside(const SkinShape& shape, const Visit& visit) const {
    const double reach = 1.2 * shape.Reach() + 0.2, step = shape.radius_mm / std::sqrt(shape.stretch) / 25;
    for (double y = -reach; y <= reach; y += step) {
      for (double x = -reach; x <= reach; x += step) {
        const double arc = std::hypot(x, y) / scale_;
        const Eigen::Vector3d side = (x * shape.right + y * shape.down) / std::max(1e-12, std::hypot(x, y));
        const Eigen::Vector3d d = std::cos(arc) * shape.axis + std::sin(arc) * side;
        const double share = std::clamp(0.5 + shape.InsideBy(d, scale_) / step, 0.0, 1.0);
        if (share == 0) continue;
        const double shrink = arc < 1e-6 ? 1 : std::sin(arc) / arc;  // of the exponential map
        visit(d, share * step * step / (scale_ * scale_) * shrink * surface_.AreaPerSolidAngle(d));
      }
    }
  }

  void DrawDefects() {
    if (dice_.Chance(options_.intact_share)) return;
    std::vector<DefectClass> wanted(static_cast<std::size_t>(dice_.Below(9)), DefectClass::kRainSpot);
    if (dice_.Chance(0.35)) wanted.insert(wanted.begin(), DefectClass::kScar);
    if (dice_.Chance(0.30)) wanted.insert(wanted.begin(), DefectClass::kCrack);
    if (dice_.Chance(0.25)) wanted.insert(wanted.begin(), DefectClass::kDecay);
    if (wanted.empty()) wanted.push_back(DefectClass::kRainSpot);
    for (const DefectClass defect_class : wanted) PlaceApart(defect_class);
    if (dice_.Chance(options_.touching_share)) PlaceTouching();
    // The worse lies on top.
    std::stable_sort(shapes_.begin(), shapes_.end(),
                     [](const SkinShape& a, const SkinShape& b) { return a.defect_class < b.defect_class; });
  }

  Eigen::Vector3d SkinAt(const Eigen::Vector3d& d) const {
    Eigen::Vector3d colour = skin_ * std::exp(mottle_strength_ * mottle_.At(d));
    colour.x() *= std::exp(0.5 * mottle_strength_ * blush_.At(d));
    const double blush = blush_share_ / (1 + std::exp(-2.5 * blush_.At(d)));
    colour = (1 - blush) * colour + blush * Eigen::Vector3d(0.38, 0.05, 0.04);
    return colour * (1 + 0.18 * std::clamp(2.5 * (freckles_.At(d) - 1.6), 0.0, 1.0));
  }

  double UnseenShare(const SkinShape& shape) const {
    double unseen = 0, all = 0;
    VisitInside(shape, [&](const Eigen::Vector3d& d, double area) {
      all += area;
      if (!IsSeen(d)) unseen += area;
    });
    return unseen / std::max(1e-9, all);
  }

  double CoveredShare(const SkinShape& shape, const SkinShape& by) const {
    double covered = 0, all = 0;
    VisitInside(shape, [&](const Eigen::Vector3d& d, double area) {
      all += area;
      if (by.InsideBy(d, scale_) > 0) covered += area;
    });
    return covered / std::max(1e-9, all);
  }

  // Whether a shape lies clear of all the others, `except` left out.
  bool IsApart(const SkinShape& shape, const SkinShape* except = nullptr) const {
    return std::all_of(shapes_.begin(), shapes_.end(), [&](const SkinShape& other) {
      const double away = scale_ * std::acos(std::clamp(shape.axis.dot(other.axis), -1.0, 1.0));
      return &other == except || away > shape.Reach() + other.Reach() + kApart;
    });
  }

  bool FitsFruit(const SkinShape& shape) const {
    return shape.Reach() < 0.62 * scale_ && shape.axis.z() - shape.Reach() / scale_ > -0.52;
  }

  void PlaceApart(DefectClass defect_class) {
    for (int trial = 0; trial < 30; ++trial) {
      const Eigen::Vector3d axis = dice_.Direction();
      if (axis.z() > 0.9) continue;
      const SkinShape shape = DrawShape(dice_, defect_class, SkinAt(axis), axis);
      if (!FitsFruit(shape) || !IsApart(shape) || UnseenShare(shape) > 0.001) continue;
      shapes_.push_back(shape);
      return;
    }
  }

  // A rain spot on the rim of one of the defects.
  void PlaceTouching() {
    if (shapes_.empty()) return;
    const SkinShape& host = shapes_[static_cast<std::size_t>(dice_.Below(static_cast<int>(shapes_.size())))];
    for (int trial = 0; trial < 200; ++trial) {
      const Eigen::Vector3d aim = host.axis + 1.5 * host.Reach() / scale_ * dice_.Direction();
      const SkinShape shape = DrawShape(dice_, DefectClass::kRainSpot, SkinAt(host.axis), aim.normalized());
      const double inside = host.InsideBy(shape.axis, scale_) / shape.radius_mm;
      if (inside > -0.3 || inside < -1.05 || !FitsFruit(shape) || !IsApart(shape, &host)) continue;
      if (UnseenShare(shape) > 0.001 || CoveredShare(shape, host) > kMostCovered) continue;
      if (CoveredShare(host, shape) > kMostCovered) continue;
      touching_ = {shape.axis, host.axis};
      shapes_.push_back(shape);
      return;
    }
  }

  void DrawGaps() {
    for (int k = 8 + dice_.Below(18); k > 0; --k) {
      Gap gap;
      gap.axis = dice_.Direction();
      gap.right = Eigen::Vector3d::UnitZ().cross(gap.axis).normalized();
      gap.down = gap.axis.cross(gap.right);
      gap.half_width_mm = dice_.Uniform(0.1, 0.4);
      gap.half_height_mm = dice_.Uniform(0.3, 2);
      gaps_.push_back(gap);
      const bool hides = std::any_of(shapes_.begin(), shapes_.end(),
                                     [&](const SkinShape& shape) { return UnseenShare(shape) > kMostUnseen; });
      if (hides) gaps_.pop_back();
    }
  }

  Eigen::Vector3d LitColour(const Eigen::Vector3d& d, int view) const {
    Eigen::Vector3d colour = SkinAt(d);
    for (const SkinShape& shape : shapes_) {
      const double soft = std::hypot(shape.soft_mm, kLens);
      const double t = shape.cover * std::clamp(0.5 + shape.InsideBy(d, scale_) / (2 * soft), 0.0, 1.0);
      if (t == 0) continue;
      colour = (1 - t) * colour + t * shape.linear * (1 + 0.4 * mottle_strength_ * mottle_.At(3 * d));
    }
    if (tinted_) {
      const double tint = 1 / (1 + std::exp(-14 * (d.dot(tint_axis_) - 0.75)));
      colour = colour.cwiseProduct(Eigen::Vector3d(1 - 0.12 * tint, 1 - 0.22 * tint, 1 - 0.18 * tint));
    }
    colour *= view_gains_[static_cast<std::size_t>(view)] * (0.82 + 0.18 * d.z()) * (1 + 0.04 * light_.At(d));
    for (const Lobe& lobe : lobes_) {
      colour.array() += lobe.strength * std::exp(-(1 - d.dot(lobe.axis)) * 2 / (lobe.width * lobe.width));
    }
    return colour;
  }

  void AddPoint(const Eigen::Vector3d& d, PointCloud& cloud) {
    const double turn = std::atan2(d.y(), d.x()) / (2 * pi) + 0.5 + 0.01 * seam_.At(d);
    const int view = static_cast<int>(std::floor(turn * kViews) + kViews) % kViews;
    double radius = RadiusAt(d) + view_offsets_[static_cast<std::size_t>(view)];
    for (const SkinShape& shape : shapes_) {
      radius -= shape.depth_mm * std::clamp(shape.InsideBy(d, scale_) / 0.3, 0.0, 1.0);
    }
    radius += place_noise_ * place_error_.At(d) + 0.008 * dice_.Normal();
    const Eigen::Vector3d srgb = 255 * LitColour(d, view).array().max(0).min(1).pow(1 / 2.2);
    Rgb8 colour;
    for (int c = 0; c < 3; ++c) {
      colour[c] = static_cast<std::uint8_t>(std::clamp(srgb[c] + noise_ * dice_.Normal() + 0.5, 0.0, 255.0));
    }
    cloud.positions.push_back((centre_ + radius * d).cast<float>());
    cloud.colours.push_back(colour);
  }

  // The mean over all horizontal directions of the distance between the two tangent planes.
  double EquatorialDiameter() const {
    constexpr int kTurns = 60;
    const CubeMap map(kTruthCells);
    double sum = 0;
    for (int k = 0; k < kTurns; ++k) {
      const double angle = pi * k / kTurns;
      double low = std::numeric_limits<double>::max(), high = std::numeric_limits<double>::lowest();
      for (int cell = 0; cell < map.size(); ++cell) {
        const Eigen::Vector3d x = surface_.PointAt(map.DirectionOf(cell)) - centre_;
        const double at = std::cos(angle) * x.x() + std::sin(angle) * x.y();
        low = std::min(low, at);
        high = std::max(high, at);
      }
      sum += (high - low) / kTurns;
    }
    return sum;
  }

  // Length of the outline on the skin.
  double Perimeter(const SkinShape& shape) const {
    constexpr int kSteps = 720;
    std::vector<Eigen::Vector3d> line;
    for (int k = 0; k < kSteps; ++k) {
      const Eigen::Vector2d flat = shape.OutlineAt(2 * pi * k / kSteps);
      const double arc = flat.norm() / scale_;
      const Eigen::Vector3d side = (flat.x() * shape.right + flat.y() * shape.down) / flat.norm();
      line.push_back(surface_.PointAt(std::cos(arc) * shape.axis + std::sin(arc) * side));
    }
    double length = 0;
    for (int k = 0; k < kSteps; ++k) length += (line[(k + 1) % kSteps] - line[k]).norm();
    return length;
  }

  TrueDefect TruthOf(const SkinShape& shape) const {
    TrueDefect defect{.defect_class = shape.defect_class, .stretch = shape.stretch};
    Eigen::Vector3d middle = Eigen::Vector3d::Zero();
    VisitInside(shape, [&](const Eigen::Vector3d& d, double area) {
      defect.area_mm2 += area;
      middle += area * d;
    });
    defect.centre_mm = surface_.PointAt(middle);
    defect.perimeter_mm = Perimeter(shape);
    const Eigen::Vector3d skin = SkinAt(shape.axis);
    defect.lightness_step = LabFromLinear(shape.ColourOn(skin).cast<float>())[0] - LabFromLinear(skin.cast<float>())[0];
    defect.touching = std::find(touching_.begin(), touching_.end(), shape.axis) != touching_.end();
    return defect;
  }

  FruitTruth Truth() const {
    FruitTruth truth;
    truth.centre_mm = centre_;
    truth.volume_mm3 = surface_.Volume();
    truth.surface_area_mm2 = surface_.Area();
    truth.equatorial_diameter_mm = EquatorialDiameter();
    for (const SkinShape& shape : shapes_) {
      truth.defects.push_back(TruthOf(shape));
      truth.grade = std::max(truth.grade, shape.defect_class);
    }
    return truth;
  }

  Dice dice_;
  RandomFruitOptions options_;
  SmoothNoise bumps_, mottle_, blush_, light_, freckles_, place_error_, seam_;
  double equatorial_ = 18, polar_ = 18, oval_ = 0, hollow_ = 0, suture_ = 0, azimuth_ = 0, scale_ = 18;
  Eigen::Vector3d centre_ = Eigen::Vector3d::Zero(), skin_ = Eigen::Vector3d::Zero();
  double blush_share_ = 0, mottle_strength_ = 0.1, noise_ = 1, place_noise_ = 0.01;
  FruitSurface surface_;
  std::vector<Lobe> lobes_;
  bool tinted_ = false, hidden_side_ = false;
  Eigen::Vector3d tint_axis_ = Eigen::Vector3d::UnitX(), hidden_axis_ = Eigen::Vector3d::UnitX();
  std::array<double, kViews> view_gains_{}, view_offsets_{};
  std::vector<SkinShape> shapes_;
  std::vector<Eigen::Vector3d> touching_;
  std::vector<Gap> gaps_;
};

}  // namespace

RandomFruit MakeRandomFruit(std::uint64_t seed, const RandomFruitOptions& options) {
  return FruitDrawing(seed, options).Sample();
}

}  // namespace drupe
