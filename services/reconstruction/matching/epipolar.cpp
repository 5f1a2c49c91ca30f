#include "reconstruction/matching/epipolar.h"

#include <algorithm>
#include <cmath>

namespace drupe {

Eigen::Matrix3d CrossMatrix(const Eigen::Vector3d& v) {
  Eigen::Matrix3d cross;
  cross << 0, -v.z(), v.y(), v.z(), 0, -v.x(), -v.y(), v.x(), 0;
  return cross;
}

Eigen::Matrix3d EssentialFromPose(const Rigid3& second_from_first) {
  return CrossMatrix(second_from_first.translation) * second_from_first.rotation;
}

Eigen::Vector2d DepthsOf(const Rigid3& second_from_first, const PointPair& pair) {
  // depth_2 * b - depth_1 * R a = t, by least squares.
  const Eigen::Vector3d a = second_from_first.rotation * pair.first.homogeneous();
  const Eigen::Vector3d b = pair.second.homogeneous();
  const Eigen::Vector3d& t = second_from_first.translation;
  const double aa = a.squaredNorm(), bb = b.squaredNorm(), ab = a.dot(b);
  const double determinant = aa * bb - ab * ab;
  if (determinant < 1e-14 * aa * bb) return Eigen::Vector2d::Zero();
  const double at = a.dot(t), bt = b.dot(t);
  return Eigen::Vector2d(ab * bt - bb * at, aa * bt - ab * at) / determinant;
}

double TriangulationAngle(const Rigid3& second_from_first, const PointPair& pair) {
  const Eigen::Vector3d a = second_from_first.rotation * pair.first.homogeneous();
  const Eigen::Vector3d b = pair.second.homogeneous();
  return std::atan2(a.cross(b).norm(), a.dot(b));
}

}  // namespace drupe
