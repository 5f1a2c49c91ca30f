#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "geometry/rigid3.h"
#include "geometry/triangulation.h"
#include "reconstruction/sparse/sparse.h"

namespace drupe {

/// A measured image position, with what the adjustments need of the lens: near the measurement a difference d of
/// normalised coordinates is a difference pixel_from_normalised * d of pixels.
struct ImageMeasurement {
  Eigen::Vector2d pixel;                  ///< as detected
  Eigen::Vector2d xy;                     ///< normalised image coordinates without distortion
  Eigen::Matrix2d pixel_from_normalised;  ///< Jacobian at xy
};

struct SfmObservation {
  std::int32_t view = 0;
  std::int32_t track = 0;
  std::uint32_t keypoint = 0;
  bool is_active = false;  ///< agrees with the track's position
  float sigma_px = 1;      ///< expected localisation error: grows with the keypoint's scale
  ImageMeasurement measured;
};

/// A track under reconstruction; its observations are [begin, end) of SfmState::observations.
struct SfmTrack {
  std::size_t begin = 0, end = 0;
  bool has_position = false;
  Eigen::Vector3d position = Eigen::Vector3d::Zero();
  std::int32_t share = 0;  ///< of the adjustment's work: the tracks with equal numbers are eliminated together
};

/// A corner of the board seen in a view. The printed marker may be larger or smaller than planned: its corner lies at
/// planned + spread * outward.
struct BoardCorner {
  Eigen::Vector3d planned;  ///< mm, board frame
  Eigen::Vector3d outward;  ///< from the marker's middle to the corner, one unit along each side
  ImageMeasurement measured;
};

/// A structure from motion in progress. Plain data: the stages in this folder read and write it in turn.
struct SfmState {
  PinholeCamera camera;
  std::vector<SfmObservation> observations;
  std::vector<SfmTrack> tracks;
  std::vector<std::vector<std::size_t>> view_observations;  ///< per view, indices of observations, ascending
  std::vector<std::vector<BoardCorner>> board_corners;      ///< per view; empty: none seen, or not trusted
  std::vector<std::optional<Rigid3>> poses;                 ///< cam_from_world per view
  std::vector<std::string> reasons;                         ///< per view: why there is no pose
  bool is_metric = false;                                   ///< the world is the board's frame
  double ink_spread_mm = 0;                                 ///< of the board, see BoardCorner

  int ViewCount() const { return static_cast<int>(poses.size()); }
  int RegisteredCount() const;
  double FocalPx() const { return 0.5 * (camera.fx + camera.fy); }
  std::span<const SfmObservation> ObservationsOf(const SfmTrack& track) const {
    return {observations.data() + track.begin, track.end - track.begin};
  }
  std::span<SfmObservation> ObservationsOf(const SfmTrack& track) {
    return {observations.data() + track.begin, track.end - track.begin};
  }
};

/// Deals the tracks out to `count` shares of about equal size, neighbours in the list together.
void ShareByOrder(int count, SfmState& state);

/// Gives every track to the cluster (view indices, ascending) that has most of its views, the first of equals.
void ShareByCluster(const std::vector<std::vector<int>>& clusters, SfmState& state);

/// Undistorts every measurement once and lays tracks and board corners out for the stages.
SfmState MakeSfmState(const SparseInput& input);

/// How far a keypoint of this scale lies off compared with the smallest ones, >= 1.
float ExpectedSigmaPx(float scale_px);

/// What `feature`, the `keypoint`, measures with this camera; of no track yet and not active.
SfmObservation MakeObservation(const PinholeCamera& camera, const FeatureRef& feature, const Keypoint& keypoint);

/// Measurements again after `state.camera` has changed (refined intrinsics).
void Remeasure(SfmState& state);

/// Pixels between a measurement and the projection of a point; infinity behind the camera.
double ErrorPx(const Rigid3& cam_from_world, const ImageMeasurement& measured, const Eigen::Vector3d& point);

}  // namespace drupe
