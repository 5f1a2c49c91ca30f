#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "geometry/pinhole_camera.h"
#include "geometry/rigid3.h"

namespace drupe {

enum class ScaleSource { kNone, kBoard };
enum class IntrinsicsSource { kGiven, kExif, kEstimated };

/// One picture of the set and where it was taken from.
struct View {
  std::string image;                      ///< name in the image set, "00.jpg"
  std::optional<Rigid3> cam_from_world;   ///< nothing: not registered
  std::string reason;                     ///< why it is not registered; empty when it is
  double mean_reprojection_error_px = 0;  ///< over its observations
  int observation_count = 0;
  double centre_sigma = 0;        ///< standard uncertainty of the camera's centre, world unit; 0: not known
  double rotation_sigma_deg = 0;  ///< standard uncertainty of the rotation's angle
};

/// Where a track is seen: undistorted nowhere, the pixel as detected.
struct Observation {
  std::int32_t view = 0;
  std::uint32_t keypoint = 0;  ///< index in the view's Features
  Eigen::Vector2f pixel = Eigen::Vector2f::Zero();
};

/// A surface point seen in two views or more.
struct Track {
  Eigen::Vector3d position = Eigen::Vector3d::Zero();  ///< world frame; mm when the scale is metric
  Eigen::Matrix<std::uint8_t, 3, 1> colour = Eigen::Matrix<std::uint8_t, 3, 1>::Zero();  ///< RGB
  std::vector<Observation> observations;               ///< ascending by view, one a view
  double mean_reprojection_error_px = 0;
  double position_sigma = 0;  ///< standard uncertainty of the position, world unit; 0: not known
};

/// Result of structure from motion: one camera, the poses of the views, the tracks. With a board, the world is the
/// board's frame in mm (origin in the board's middle, z up); without, an arbitrary frame of arbitrary scale.
struct SparseModel {
  PinholeCamera camera;
  IntrinsicsSource intrinsics_source = IntrinsicsSource::kGiven;
  ScaleSource scale_source = ScaleSource::kNone;
  std::vector<View> views;  ///< in the order of the image set
  std::vector<Track> tracks;
  double board_rms_px = 0;         ///< reprojection error of the board's corners; 0 without a board
  int board_observations = 0;      ///< corners seen, over all views
  double scale_relative_sigma = 0; ///< standard uncertainty of the scale, relative; 0 when unknown
  double mean_reprojection_error_px = 0;

  int RegisteredCount() const {
    int count = 0;
    for (const View& view : views) count += view.cam_from_world.has_value() ? 1 : 0;
    return count;
  }
};

}  // namespace drupe
