#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "geometry/cube_table.h"
#include "image/colour.h"

namespace drupe {

/// The closed surface of one fruit, seen from its centre: the distance to the skin in every direction (a star-shaped
/// body; plums, jujubes, cherries and nectarines are, their grooves and cavities included). Lengths in mm.
class FruitSurface {
 public:
  FruitSurface() = default;
  FruitSurface(const Eigen::Vector3d& centre, CubeTable<float> radius);

  const Eigen::Vector3d& centre() const { return centre_; }
  /// Distance from the centre to the skin, bilinear between the corners; `direction` need not have unit length.
  float RadiusAt(const Eigen::Vector3f& direction) const { return radius_.At(direction); }
  /// The skin's point in a direction, world frame.
  Eigen::Vector3d PointAt(const Eigen::Vector3d& direction) const;
  /// The skin's unit normal in a direction, away from the fruit.
  Eigen::Vector3d NormalAt(const Eigen::Vector3d& direction) const;
  /// Area of skin a unit of solid angle, in mm2.
  double AreaPerSolidAngle(const Eigen::Vector3d& direction) const;

  double Area() const { return area_; }      ///< mm2
  double Volume() const { return volume_; }  ///< mm3
  double MeanRadius() const { return mean_radius_; }

 private:
  Eigen::Vector3d Corner(int face, int column, int row) const;
  void Integrate();

  Eigen::Vector3d centre_ = Eigen::Vector3d::Zero();
  CubeTable<float> radius_;
  double area_ = 0;
  double volume_ = 0;
  double mean_radius_ = 0;
};

/// One fruit of the dense cloud: the points of its skin, and the surface through them. The vectors have equal length.
struct FruitCloud {
  std::vector<Eigen::Vector3f> offsets;  ///< position minus the surface's centre
  std::vector<Rgb8> colours;
  std::vector<Eigen::Vector3f> lab;
  FruitSurface surface;
  Eigen::Vector3d up = Eigen::Vector3d::UnitZ();  ///< the polar axis: the needle's direction where it is known
  double observed_share = 0;                      ///< of the surface's area, 0..1
  double noise_mm = 0;                            ///< robust standard deviation of the points across the surface
  double mm_per_unit = 1;  ///< what the world's lengths were multiplied by; 1 with a metric scale

  std::size_t size() const { return offsets.size(); }
};

}  // namespace drupe
