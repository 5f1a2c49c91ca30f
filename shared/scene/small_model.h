#pragma once

#include <Eigen/Geometry>
#include <string>

#include "scene/sparse_model.h"

namespace drupe {

/// For tests: three views, the second not registered, and two tracks.
inline SparseModel SmallModel() {
  SparseModel model;
  model.camera = {.width = 640,
                  .height = 480,
                  .fx = 800,
                  .fy = 810,
                  .cx = 320.25,
                  .cy = 239.5,
                  .dist = {-0.1, 0.02, 1e-3, 2e-3, 0}};
  model.scale_source = ScaleSource::kBoard;
  model.board_rms_px = 0.05;
  model.mean_reprojection_error_px = 0.25;
  for (int v = 0; v < 3; ++v) {
    View view;
    view.image = std::to_string(v) + ".jpg";
    if (v == 2) view.centre_sigma = 0.004, view.rotation_sigma_deg = 0.002;
    if (v == 1) {
      view.reason = "shares 3 points with the other pictures, 15 are needed";
    } else {
      Rigid3 pose;
      pose.rotation = Eigen::AngleAxisd(0.3 * v, Eigen::Vector3d(1, 2, 3).normalized()).toRotationMatrix();
      pose.translation = Eigen::Vector3d(1.5, -2.25, 200 + v);
      view.cam_from_world = pose;
      view.mean_reprojection_error_px = 0.25;
      view.observation_count = 2;
    }
    model.views.push_back(view);
  }
  Track track;
  track.position = Eigen::Vector3d(1.25, 2.5, -3.75);
  track.colour << 200, 100, 50;
  track.observations = {{0, 7, {100.5f, 50.25f}}, {2, 9, {110.75f, 60.0f}}};
  track.mean_reprojection_error_px = 0.5;
  track.position_sigma = 0.0625;
  model.tracks.push_back(track);
  track.position = Eigen::Vector3d(4, 5, 6);
  track.observations = {{0, 3, {20.0f, 30.0f}}, {2, 1, {25.0f, 35.0f}}};
  model.tracks.push_back(track);
  return model;
}

}  // namespace drupe
