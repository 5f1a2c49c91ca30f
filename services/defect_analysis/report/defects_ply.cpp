#include "defect_analysis/report/defects_ply.h"

#include <Eigen/Geometry>
#include <algorithm>

#include "image/colour.h"
#include "scene/ply.h"

namespace drupe {
namespace {

constexpr double kFruitReach = 0.7;  // of a fruit's larger diameter, from its centre

// A defect's contour seen along its normal.
class FlatContour {
 public:
  explicit FlatContour(const Defect& defect) : defect_(defect) {
    right_ = defect.normal.unitOrthogonal();
    down_ = defect.normal.cross(right_);
    for (const Eigen::Vector3d& p : defect.contour_mm) {
      line_.push_back(Flat(p));
      reach_ = std::max(reach_, (p - defect.centre_mm).norm());
    }
  }

  const Defect& defect() const { return defect_; }

  bool Holds(const Eigen::Vector3d& x) const {
    if ((x - defect_.centre_mm).squaredNorm() > 1.1 * reach_ * reach_) return false;
    const Eigen::Vector2d p = Flat(x);
    bool inside = false;
    for (std::size_t i = 0, j = line_.size() - 1; i < line_.size(); j = i++) {
      const Eigen::Vector2d &a = line_[i], &b = line_[j];
      if ((a.y() > p.y()) == (b.y() > p.y())) continue;
      if (p.x() < a.x() + (p.y() - a.y()) / (b.y() - a.y()) * (b.x() - a.x())) inside = !inside;
    }
    return inside;
  }

 private:
  Eigen::Vector2d Flat(const Eigen::Vector3d& x) const {
    const Eigen::Vector3d offset = x - defect_.centre_mm;
    return {offset.dot(right_), offset.dot(down_)};
  }

  const Defect& defect_;
  Eigen::Vector3d right_, down_;
  std::vector<Eigen::Vector2d> line_;
  double reach_ = 0;
};

struct FruitContours {
  Eigen::Vector3d centre;
  double reach;
  std::vector<FlatContour> contours;
};

// The worst defect whose contour holds the point, or healthy; nothing off the fruit.
std::optional<DefectClass> ClassAt(const std::vector<FruitContours>& fruits, const Eigen::Vector3d& x) {
  for (const FruitContours& fruit : fruits) {
    if ((x - fruit.centre).norm() > fruit.reach) continue;
    DefectClass worst = DefectClass::kIntact;
    for (const FlatContour& contour : fruit.contours) {
      if (contour.Holds(x)) worst = std::max(worst, contour.defect().defect_class);
    }
    return worst;
  }
  return std::nullopt;
}

void Add(const Eigen::Vector3f& position, const Rgb8& colour, PointCloud& cloud) {
  cloud.positions.push_back(position);
  cloud.colours.push_back(colour);
}

}  // namespace

Rgb8 ClassColour(DefectClass defect_class) {
  switch (defect_class) {
    case DefectClass::kRainSpot:
      return {40, 120, 255};
    case DefectClass::kScar:
      return {255, 200, 0};
    case DefectClass::kCrack:
      return {255, 40, 40};
    case DefectClass::kDecay:
      return {190, 60, 220};
    case DefectClass::kIntact:
      break;
  }
  return {160, 160, 160};
}

std::string DefectsPly(const PointCloud& cloud, const std::vector<Fruit>& fruits) {
  std::vector<FruitContours> contours;
  PointCloud coloured;
  for (const Fruit& fruit : fruits) {
    const double reach = kFruitReach * std::max(fruit.equatorial_diameter_mm, fruit.polar_diameter_mm);
    contours.push_back({fruit.centre_mm, reach, {}});
    for (const Defect& defect : fruit.defects) {
      if (defect.contour_mm.size() >= 3) contours.back().contours.emplace_back(defect);
      for (const Eigen::Vector3d& p : defect.contour_mm) Add(p.cast<float>(), {255, 255, 255}, coloured);
    }
  }
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    const auto defect_class = ClassAt(contours, cloud.positions[i].cast<double>());
    if (!defect_class) continue;
    const Rgb8& own = cloud.colours[i];
    const auto grey = static_cast<std::uint8_t>((own[0] + 2 * own[1] + own[2]) / 4);
    Add(cloud.positions[i], *defect_class == DefectClass::kIntact ? Rgb8(grey, grey, grey) : ClassColour(*defect_class),
        coloured);
  }
  return WritePly(coloured);
}

}  // namespace drupe
