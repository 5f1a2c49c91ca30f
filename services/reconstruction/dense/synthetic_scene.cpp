#include "reconstruction/dense/synthetic_scene.h"

#include <Eigen/Geometry>
#include <cmath>
#include <numbers>
#include <random>
#include <string>

namespace drupe::dense {

namespace {

std::optional<Eigen::Vector3d> HitBall(const Eigen::Vector3d& origin, const Eigen::Vector3d& direction) {
  const Eigen::Vector3d unit = direction.normalized(), to_centre = kBallCentre - origin;
  const double along = unit.dot(to_centre);
  const double half_chord2 = kBallRadius * kBallRadius - (to_centre.squaredNorm() - along * along);
  if (half_chord2 < 0 || along < 0) return std::nullopt;
  return Eigen::Vector3d(origin + unit * (along - std::sqrt(half_chord2)));
}

Track MakeTrack(const SparseModel& model, const Eigen::Vector3d& outward, double off) {
  Track track;
  track.position = kBallCentre + outward * (kBallRadius + off);
  for (std::size_t view = 0; view < model.views.size(); ++view) {
    const Rigid3& pose = *model.views[view].cam_from_world;
    if (outward.dot((pose.Centre() - track.position).normalized()) < 0.6) continue;
    Observation observation;
    observation.view = static_cast<std::int32_t>(view);
    observation.pixel = model.camera.Project(pose * track.position)->cast<float>();
    track.observations.push_back(observation);
  }
  return track;
}

}  // namespace

double TextureAt(const Eigen::Vector3d& point) {
  constexpr int kWaves = 12;
  double sum = 0;
  for (int i = 0; i < kWaves; ++i) {
    const double a = 2.4 * i, b = 1.7 * i + 0.3;
    const Eigen::Vector3d direction(std::cos(a) * std::sin(b), std::sin(a) * std::sin(b), std::cos(b));
    sum += std::sin((1.2 + 0.25 * i) * direction.dot(point) + 0.9 * i);
  }
  return 0.5 + 0.5 * std::tanh(sum / 2.5);
}

Rigid3 LookingAt(const Eigen::Vector3d& position, const Eigen::Vector3d& target) {
  const Eigen::Vector3d forward = (target - position).normalized();
  const Eigen::Vector3d right = forward.cross(Eigen::Vector3d::UnitZ()).normalized();
  Rigid3 pose;
  pose.rotation.row(0) = right;
  pose.rotation.row(1) = forward.cross(right);
  pose.rotation.row(2) = forward;
  pose.translation = -(pose.rotation * position);
  return pose;
}

std::vector<RgbImage> Render(const SparseModel& model, const SurfaceHit& hit) {
  std::vector<RgbImage> pictures;
  for (const View& view : model.views) {
    RgbImage picture(model.camera.width, model.camera.height, 3);
    const Eigen::Vector3d origin = view.cam_from_world->Centre();
    for (int y = 0; y < picture.height(); ++y) {
      for (int x = 0; x < picture.width(); ++x) {
        const Eigen::Vector2d xy = model.camera.NormalisedFromPixel({x, y});
        const auto point = hit(origin, view.cam_from_world->rotation.transpose() * xy.homogeneous());
        const double value = point ? 60 + 120 * TextureAt(*point) : 20;
        picture.At(x, y, 0) = static_cast<std::uint8_t>(0.6 * value + 0.5);
        picture.At(x, y, 1) = static_cast<std::uint8_t>(value + 0.5);
        picture.At(x, y, 2) = static_cast<std::uint8_t>(0.3 * value + 0.5);
      }
    }
    pictures.push_back(std::move(picture));
  }
  return pictures;
}

SyntheticScene MakeBallScene() {
  constexpr int kViews = 24, kTracks = 150;
  SyntheticScene scene;
  scene.model.camera = {240, 200, 460, 460, 119.5, 99.5, {-0.05, 0.01, 0, 0, 0}};
  scene.model.scale_source = ScaleSource::kBoard;
  for (int i = 0; i < kViews; ++i) {
    const double azimuth = 2 * std::numbers::pi * i / kViews;
    View view;
    view.image = std::to_string(i) + ".png";
    view.cam_from_world =
        LookingAt(kBallCentre + Eigen::Vector3d(95 * std::cos(azimuth), 95 * std::sin(azimuth), 40), kBallCentre);
    scene.model.views.push_back(view);
  }
  std::mt19937 random(7);
  std::uniform_real_distribution<double> uniform(-1, 1);
  for (int i = 0; i < kTracks; ++i) {
    const double z = 0.2 + 0.75 * uniform(random), azimuth = std::numbers::pi * uniform(random);
    const double r = std::sqrt(1 - z * z);
    const Track track =
        MakeTrack(scene.model, {r * std::cos(azimuth), r * std::sin(azimuth), z}, 0.1 * uniform(random));
    if (track.observations.size() >= 2) scene.model.tracks.push_back(track);
  }
  scene.pictures = Render(scene.model, HitBall);
  return scene;
}

}  // namespace drupe::dense
