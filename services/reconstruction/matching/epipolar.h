#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <span>
#include <vector>

#include "geometry/rigid3.h"

namespace drupe {

/// Two places of one surface point: normalised image coordinates (undistorted, z = 1) in the first and second picture.
struct PointPair {
  Eigen::Vector2d first;
  Eigen::Vector2d second;
};

/// The matrix v x.
Eigen::Matrix3d CrossMatrix(const Eigen::Vector3d& v);

/// E with second^T E first = 0; for |translation| = 1.
Eigen::Matrix3d EssentialFromPose(const Rigid3& second_from_first);

/// Squared Sampson distance (Hartley & Zisserman 2004, eq. 11.9), in the unit of the coordinates.
inline double SquaredSampson(const Eigen::Matrix3d& e, const PointPair& pair) {
  const Eigen::Vector3d line = e * pair.first.homogeneous();
  const Eigen::Vector2d back =
      e.topLeftCorner<2, 2>().transpose() * pair.second + e.bottomLeftCorner<1, 2>().transpose();
  const double residual = pair.second.homogeneous().dot(line);
  return residual * residual / (line.head<2>().squaredNorm() + back.squaredNorm());
}

/// Where the places of the first picture lie in the second: a place x at inverse depth w at at_infinity * x + w *
/// epipole. For a calibrated pair at_infinity is the rotation and w 1 / depth in units of 1 / baseline; for a
/// fundamental matrix it is a homography that goes with it, and w a projective depth.
struct EpipolarTransfer {
  Eigen::Matrix3d at_infinity = Eigen::Matrix3d::Identity();
  Eigen::Vector3d epipole = Eigen::Vector3d::UnitX();  ///< norm 1
};

EpipolarTransfer TransferFromPose(const Rigid3& second_from_first);

/// Of all homographies that go with the matrix the one nearest to the rotation of `pose` (Frobenius), and the epipole
/// on the side of its translation, so that projective depths are about those of cameras that stand so.
EpipolarTransfer TransferFromFundamental(const Eigen::Matrix3d& fundamental, const Rigid3& pose);

/// The inverse depth of a pair, by least squares; 0 where its second place is the epipole.
double InverseDepthOf(const EpipolarTransfer& transfer, const PointPair& pair);

/// Depths of the point in the first and second camera (rays' nearest points), in units of |translation|. Both 0 when
/// the rays are parallel.
Eigen::Vector2d DepthsOf(const Rigid3& second_from_first, const PointPair& pair);

/// The angle between the two rays, radians.
double TriangulationAngle(const Rigid3& second_from_first, const PointPair& pair);

}  // namespace drupe
