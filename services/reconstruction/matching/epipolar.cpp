#include "reconstruction/matching/epipolar.h"

#include <Eigen/SVD>
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

EpipolarTransfer TransferFromPose(const Rigid3& second_from_first) {
  return {second_from_first.rotation, second_from_first.translation.normalized()};
}

EpipolarTransfer TransferFromFundamental(const Eigen::Matrix3d& fundamental, const Rigid3& pose) {
  // All such homographies are s [e]x F + e v^T (Hartley & Zisserman 2004, section 13.1), and e^T [e]x F = 0: s and v
  // can be chosen one after the other.
  const Eigen::JacobiSVD<Eigen::Matrix3d> svd(fundamental, Eigen::ComputeFullU);
  Eigen::Vector3d epipole = svd.matrixU().col(2);
  if (epipole.dot(pose.translation) < 0) epipole = -epipole;
  const Eigen::Matrix3d special = CrossMatrix(epipole) * fundamental;
  const double scale = special.cwiseProduct(pose.rotation).sum() / special.squaredNorm();
  return {scale * special + epipole * (epipole.transpose() * pose.rotation), epipole};
}

double InverseDepthOf(const EpipolarTransfer& transfer, const PointPair& pair) {
  const Eigen::Vector3d b = pair.second.homogeneous();
  const Eigen::Vector3d across = b.cross(transfer.epipole);
  const double squared = across.squaredNorm();
  if (squared < 1e-14 * b.squaredNorm()) return 0;
  return -across.dot(b.cross(transfer.at_infinity * pair.first.homogeneous())) / squared;
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
