#include "scene/sparse_export.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cstring>
#include <vector>

#include "scene/text_writer.h"

namespace drupe {
namespace {

/// Numbers of the registered views in the NVM file, -1 for others.
std::vector<int> RegisteredNumbers(const SparseModel& model) {
  std::vector<int> numbers;
  int next = 0;
  for (const View& view : model.views) numbers.push_back(view.cam_from_world ? next++ : -1);
  return numbers;
}

void AddNvmPoint(const SparseModel& model, const Track& track, const std::vector<int>& numbers, double focal,
                 TextWriter& text) {
  text.Add(track.position.x()).Add(track.position.y()).Add(track.position.z());
  for (int c = 0; c < 3; ++c) text.Add(static_cast<int>(track.colour[c]));
  text.Add(track.observations.size());
  for (const Observation& observation : track.observations) {
    const Eigen::Vector2d xy = model.camera.NormalisedFromPixel(observation.pixel.cast<double>());
    text.Add(numbers[observation.view]).Add(observation.keypoint);
    text.Add(static_cast<float>(focal * xy.x())).Add(static_cast<float>(focal * xy.y()));
  }
  text.EndLine();
}

/// Bilinear value of a channel; the pixel is clamped into the picture.
double SampleChannel(const RgbImage& image, const Eigen::Vector2f& pixel, int channel) {
  const double x = std::clamp<double>(pixel.x(), 0, image.width() - 1),
               y = std::clamp<double>(pixel.y(), 0, image.height() - 1);
  const int x0 = static_cast<int>(x), y0 = static_cast<int>(y);
  const int x1 = std::min(x0 + 1, image.width() - 1), y1 = std::min(y0 + 1, image.height() - 1);
  const double fx = x - x0, fy = y - y0;
  return (image.At(x0, y0, channel) * (1 - fx) + image.At(x1, y0, channel) * fx) * (1 - fy) +
         (image.At(x0, y1, channel) * (1 - fx) + image.At(x1, y1, channel) * fx) * fy;
}

}  // namespace

std::string SparsePly(const SparseModel& model) {
  std::string ply = "ply\nformat binary_little_endian 1.0\nelement vertex " + std::to_string(model.tracks.size()) +
                    "\nproperty float x\nproperty float y\nproperty float z\nproperty uchar red\nproperty uchar green\n"
                    "property uchar blue\nproperty float sigma\nproperty float error\nend_header\n";
  constexpr std::size_t kColourStart = 3 * sizeof(float), kQualityStart = kColourStart + 3;
  constexpr std::size_t kVertexBytes = kQualityStart + 2 * sizeof(float);
  ply.reserve(ply.size() + kVertexBytes * model.tracks.size());
  for (const Track& track : model.tracks) {
    char vertex[kVertexBytes];
    const Eigen::Vector3f position = track.position.cast<float>();
    std::memcpy(vertex, position.data(), 3 * sizeof(float));
    const float quality[] = {static_cast<float>(track.position_sigma),
                             static_cast<float>(track.mean_reprojection_error_px)};
    std::memcpy(vertex + kColourStart, track.colour.data(), 3);
    std::memcpy(vertex + kQualityStart, quality, sizeof quality);
    ply.append(vertex, kVertexBytes);
  }
  return ply;
}

std::string Nvm(const SparseModel& model) {
  const double focal = 0.5 * (model.camera.fx + model.camera.fy);
  const std::vector<int> numbers = RegisteredNumbers(model);
  TextWriter text;
  text.Add("NVM_V3").EndLine().EndLine().Add(model.RegisteredCount()).EndLine();
  for (const View& view : model.views) {
    if (!view.cam_from_world) continue;
    const Eigen::Quaterniond q(view.cam_from_world->rotation);
    const Eigen::Vector3d centre = view.cam_from_world->Centre();
    text.Add(view.image).Add(focal).Add(q.w()).Add(q.x()).Add(q.y()).Add(q.z());
    text.Add(centre.x()).Add(centre.y()).Add(centre.z()).Add(0).Add(0).EndLine();
  }
  text.EndLine().Add(model.tracks.size()).EndLine();
  for (const Track& track : model.tracks) AddNvmPoint(model, track, numbers, focal, text);
  return text.EndLine().Add(0).EndLine().Take();
}

void ColourTracks(SparseModel& model, int view, const RgbImage& image) {
  for (Track& track : model.tracks) {
    if (track.observations.empty()) continue;
    const Observation& middle = track.observations[track.observations.size() / 2];
    if (middle.view != view) continue;
    for (int c = 0; c < 3; ++c) {
      const double value = SampleChannel(image, middle.pixel, std::min(c, image.channels() - 1));
      track.colour[c] = static_cast<std::uint8_t>(value + 0.5);
    }
  }
}

}  // namespace drupe
