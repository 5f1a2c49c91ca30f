#pragma once

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <random>
#include <string>
#include <vector>

#include "reconstruction/sparse/sparse.h"

namespace drupe {

/// A turntable as the tests need it: points on a sphere above the default board, a ring of cameras around, what they
/// would detect and match, and the truth.
struct SyntheticScene {
  struct Options {
    int views = 24;
    int points = 800;
    double noise_px = 0.3;
    double board_noise_px = 0.05;
    double wrong_share = 0.02;  ///< of the observations are elsewhere in the picture
    double arc_rad = 2 * M_PI;  ///< over which the cameras stand
    double ink_spread_mm = 0;
  };

  PinholeCamera camera;
  Board board = MakeGridBoard();
  std::vector<Rigid3> poses;
  std::vector<Eigen::Vector3d> points;
  std::vector<std::string> names;
  std::vector<Features> features;
  std::vector<BoardDetection> detections;
  TrackList tracks;
  MatchGraph matches;

  explicit SyntheticScene(const Options& options) : options_(options), random_(11) {
    camera.width = 1280, camera.height = 720;
    camera.fx = camera.fy = 1800, camera.cx = 633, camera.cy = 361;
    camera.dist = {-0.06, 0.01, 0.0002, -0.0001, 0};
    MakePoses();
    MakePoints();
    MakeTracks();
    MakeDetections();
    MakePairs();
  }
  SyntheticScene() : SyntheticScene(Options{}) {}

  SparseInput Input(bool with_board) const {
    SparseInput input;
    input.image_names = names;
    input.features = features;
    input.matches = &matches;
    input.tracks = &tracks;
    input.camera = camera;
    if (with_board) {
      input.board = board;
      input.detections = detections;
    }
    return input;
  }

  /// Mean distance of the camera centres from the truth, mm, without any alignment.
  double MeanCentreError(const SparseModel& model) const {
    double sum = 0;
    for (std::size_t v = 0; v < poses.size(); ++v) {
      if (model.views[v].cam_from_world) sum += (model.views[v].cam_from_world->Centre() - poses[v].Centre()).norm();
    }
    return sum / std::max(1, model.RegisteredCount());
  }

  /// Forgets what the features of a view say.
  void Blind(int view) {
    for (auto& track : tracks.tracks) std::erase_if(track, [view](const FeatureRef& ref) { return ref.view == view; });
    std::erase_if(tracks.tracks, [](const auto& track) { return track.size() < 2; });
    std::erase_if(matches.pairs, [view](const auto& p) { return p.pair.first == view || p.pair.second == view; });
  }

 private:
  double Noise(double sigma) { return std::normal_distribution<double>(0, sigma)(random_); }
  double Uniform() { return std::uniform_real_distribution<double>(0, 1)(random_); }

  void MakePoses() {
    for (int v = 0; v < options_.views; ++v) {
      const double angle = options_.arc_rad * v / options_.views;
      const Eigen::Vector3d centre(200 * std::cos(angle), 200 * std::sin(angle), 130), target(0, 0, 25);
      const Eigen::Vector3d forward = (target - centre).normalized();
      const Eigen::Vector3d right = forward.cross(Eigen::Vector3d::UnitZ()).normalized();
      Rigid3 pose;
      pose.rotation << right.transpose(), forward.cross(right).transpose(), forward.transpose();
      pose.translation = -(pose.rotation * centre);
      poses.push_back(pose);
      names.push_back(std::to_string(v) + ".jpg");
    }
  }

  void MakePoints() {
    for (int i = 0; i < options_.points; ++i) {
      const Eigen::Vector3d direction = Eigen::Vector3d(Noise(1), Noise(1), Noise(1)).normalized();
      points.push_back(Eigen::Vector3d(1, -1, 34) + 18 * direction);
    }
  }

  void MakeTracks() {
    features.resize(poses.size());
    for (const Eigen::Vector3d& point : points) {
      std::vector<FeatureRef> track;
      for (int v = 0; v < options_.views; ++v) {
        const Eigen::Vector3d normal = (point - Eigen::Vector3d(1, -1, 34)) / 18;
        if (normal.dot((poses[v].Centre() - point).normalized()) < 0.5) continue;
        Eigen::Vector2d pixel =
            *camera.Project(poses[v] * point) + Eigen::Vector2d(Noise(options_.noise_px), Noise(options_.noise_px));
        if (Uniform() < options_.wrong_share) pixel += Eigen::Vector2d(40 * Noise(1), 40 * Noise(1));
        Keypoint keypoint;
        keypoint.x = static_cast<float>(pixel.x()), keypoint.y = static_cast<float>(pixel.y()),
        keypoint.scale_px = 1.6f;
        track.push_back({v, static_cast<std::uint32_t>(features[v].size())});
        features[v].keypoints.push_back(keypoint);
      }
      if (track.size() >= 2) tracks.tracks.push_back(track);
    }
  }

  void MakeDetections() {
    for (int v = 0; v < options_.views; ++v) {
      BoardDetection detection;
      for (const auto& [id, corners] : board.corners_mm) {
        MarkerDetection marker;
        marker.id = id;
        const Eigen::Vector3d middle = 0.25 * (corners[0] + corners[1] + corners[2] + corners[3]);
        for (int k = 0; k < 4; ++k) {
          const Eigen::Vector3d printed = corners[k] + options_.ink_spread_mm * (corners[k] - middle) / 4.0;
          marker.corners_px[k] = *camera.Project(poses[v] * printed) +
                                 Eigen::Vector2d(Noise(options_.board_noise_px), Noise(options_.board_noise_px));
        }
        detection.push_back(marker);
      }
      detections.push_back(detection);
    }
  }

  /// Neighbours on the ring, with relative poses as good as a pair gives them.
  void MakePairs() {
    for (int a = 0; a < options_.views; ++a) {
      for (int b = a + 1; b < std::min(options_.views, a + 4); ++b) AddPair(a, b);
    }
  }

  void AddPair(int a, int b) {
    TwoViewMatches pair;
    pair.pair = {a, b};
    for (const auto& track : tracks.tracks) {
      const auto in_a = std::find_if(track.begin(), track.end(), [a](const FeatureRef& r) { return r.view == a; });
      const auto in_b = std::find_if(track.begin(), track.end(), [b](const FeatureRef& r) { return r.view == b; });
      if (in_a != track.end() && in_b != track.end()) pair.matches.push_back({in_a->keypoint, in_b->keypoint});
    }
    pair.second_from_first = poses[b] * poses[a].Inverse();
    pair.second_from_first.translation.normalize();
    pair.second_from_first.rotation =
        Eigen::AngleAxisd(0.002, Eigen::Vector3d(1, 1, 1).normalized()).toRotationMatrix() *
        pair.second_from_first.rotation;
    pair.calibrated = true;
    pair.median_triangulation_angle_rad = options_.arc_rad / options_.views * (b - a);
    pair.homography_inlier_share = 0.3;
    matches.pairs.push_back(pair);
  }

  Options options_;
  std::mt19937 random_;
};

/// Views of a ring of 24 in four clusters that share two views with their neighbours.
inline const std::vector<std::vector<int>> kArcs = {{0, 1, 2, 3, 4, 5, 6, 7},
                                                    {6, 7, 8, 9, 10, 11, 12, 13},
                                                    {12, 13, 14, 15, 16, 17, 18, 19},
                                                    {0, 1, 18, 19, 20, 21, 22, 23}};

}  // namespace drupe
