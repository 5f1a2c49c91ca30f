#include "scene/colmap_export.h"

#include <Eigen/Geometry>
#include <bit>
#include <cstdint>
#include <vector>

#include "scene/text_writer.h"
#include "scene/zip_writer.h"

namespace drupe {
namespace {

static_assert(std::endian::native == std::endian::little, "COLMAP's binary files are little-endian");

constexpr double kPixelCentre = 0.5;  // of COLMAP's first pixel; ours is at 0
constexpr std::uint32_t kCameraId = 1;

/// Appends numbers as they lie in memory.
class ByteWriter {
 public:
  template <typename Number>
  ByteWriter& Add(Number value) {
    bytes_.append(reinterpret_cast<const char*>(&value), sizeof(value));
    return *this;
  }
  ByteWriter& Add(const Eigen::Vector3d& vector) { return Add(vector.x()).Add(vector.y()).Add(vector.z()); }
  ByteWriter& AddTerminated(const std::string& text) {
    bytes_.append(text).push_back('\0');
    return *this;
  }
  std::string Take() { return std::move(bytes_); }

 private:
  std::string bytes_;
};

/// COLMAP's OPENCV model, or FULL_OPENCV where the third radial coefficient is needed.
struct ColmapCamera {
  const char* model;
  int model_id;
  std::vector<double> parameters;
};

ColmapCamera CameraOf(const PinholeCamera& camera) {
  ColmapCamera colmap{"OPENCV", 4, {camera.fx, camera.fy, camera.cx + kPixelCentre, camera.cy + kPixelCentre}};
  for (int i = 0; i < 4; ++i) colmap.parameters.push_back(camera.dist[i]);
  if (camera.dist[4] == 0) return colmap;
  colmap.model = "FULL_OPENCV";
  colmap.model_id = 6;
  colmap.parameters.insert(colmap.parameters.end(), {camera.dist[4], 0, 0, 0});
  return colmap;
}

std::string CamerasText(const PinholeCamera& camera) {
  const ColmapCamera colmap = CameraOf(camera);
  TextWriter text;
  text.Add(kCameraId).Add(colmap.model).Add(camera.width).Add(camera.height);
  for (const double parameter : colmap.parameters) text.Add(parameter);
  return text.EndLine().Take();
}

std::string CamerasBinary(const PinholeCamera& camera) {
  const ColmapCamera colmap = CameraOf(camera);
  ByteWriter bytes;
  bytes.Add(std::uint64_t{1}).Add(kCameraId).Add(static_cast<std::int32_t>(colmap.model_id));
  bytes.Add(static_cast<std::uint64_t>(camera.width)).Add(static_cast<std::uint64_t>(camera.height));
  for (const double parameter : colmap.parameters) bytes.Add(parameter);
  return bytes.Take();
}

/// One observation of a track, by view; the pixel as COLMAP counts.
struct SeenTrack {
  std::uint64_t id;
  Eigen::Vector2f pixel;
};

/// Per view what it sees, in the order of the tracks: the numbering that images and points share.
std::vector<std::vector<SeenTrack>> TracksByView(const SparseModel& model) {
  constexpr auto kShift = static_cast<float>(kPixelCentre);
  std::vector<std::vector<SeenTrack>> seen(model.views.size());
  for (std::size_t t = 0; t < model.tracks.size(); ++t) {
    for (const Observation& observation : model.tracks[t].observations) {
      seen[observation.view].push_back({t + 1, observation.pixel + Eigen::Vector2f(kShift, kShift)});
    }
  }
  return seen;
}

std::string ImagesText(const SparseModel& model) {
  const auto seen = TracksByView(model);
  TextWriter text;
  for (std::size_t v = 0; v < model.views.size(); ++v) {
    const View& view = model.views[v];
    if (!view.cam_from_world) continue;
    const Eigen::Quaterniond q(view.cam_from_world->rotation);
    const Eigen::Vector3d& t = view.cam_from_world->translation;
    text.Add(v + 1).Add(q.w()).Add(q.x()).Add(q.y()).Add(q.z()).Add(t.x()).Add(t.y()).Add(t.z());
    text.Add(kCameraId).Add(view.image).EndLine();
    for (const SeenTrack& point : seen[v]) text.Add(point.pixel.x()).Add(point.pixel.y()).Add(point.id);
    text.EndLine();
  }
  return text.Take();
}

std::string ImagesBinary(const SparseModel& model) {
  const auto seen = TracksByView(model);
  ByteWriter bytes;
  bytes.Add(static_cast<std::uint64_t>(model.RegisteredCount()));
  for (std::size_t v = 0; v < model.views.size(); ++v) {
    const View& view = model.views[v];
    if (!view.cam_from_world) continue;
    const Eigen::Quaterniond q(view.cam_from_world->rotation);
    bytes.Add(static_cast<std::uint32_t>(v + 1)).Add(q.w()).Add(q.x()).Add(q.y()).Add(q.z());
    bytes.Add(view.cam_from_world->translation).Add(kCameraId).AddTerminated(view.image);
    bytes.Add(static_cast<std::uint64_t>(seen[v].size()));
    for (const SeenTrack& point : seen[v]) {
      bytes.Add(static_cast<double>(point.pixel.x())).Add(static_cast<double>(point.pixel.y())).Add(point.id);
    }
  }
  return bytes.Take();
}

/// Calls add(image id, index among what the image sees) for every observation of a track; tracks come in their order.
class ObservationNumbers {
 public:
  explicit ObservationNumbers(const SparseModel& model) : next_index_(model.views.size(), 0) {}

  template <typename Function>
  void ForEach(const Track& track, const Function& add) {
    for (const Observation& observation : track.observations) {
      add(static_cast<std::uint32_t>(observation.view + 1), next_index_[observation.view]++);
    }
  }

 private:
  std::vector<std::uint32_t> next_index_;
};

std::string PointsText(const SparseModel& model) {
  ObservationNumbers numbers(model);
  TextWriter text;
  for (std::size_t t = 0; t < model.tracks.size(); ++t) {
    const Track& track = model.tracks[t];
    text.Add(t + 1).Add(track.position.x()).Add(track.position.y()).Add(track.position.z());
    for (int c = 0; c < 3; ++c) text.Add(static_cast<int>(track.colour[c]));
    text.Add(track.mean_reprojection_error_px);
    numbers.ForEach(track, [&](std::uint32_t image, std::uint32_t index) { text.Add(image).Add(index); });
    text.EndLine();
  }
  return text.Take();
}

std::string PointsBinary(const SparseModel& model) {
  ObservationNumbers numbers(model);
  ByteWriter bytes;
  bytes.Add(static_cast<std::uint64_t>(model.tracks.size()));
  for (std::size_t t = 0; t < model.tracks.size(); ++t) {
    const Track& track = model.tracks[t];
    bytes.Add(static_cast<std::uint64_t>(t + 1)).Add(track.position);
    for (int c = 0; c < 3; ++c) bytes.Add(track.colour[c]);
    bytes.Add(track.mean_reprojection_error_px).Add(static_cast<std::uint64_t>(track.observations.size()));
    numbers.ForEach(track, [&](std::uint32_t image, std::uint32_t index) { bytes.Add(image).Add(index); });
  }
  return bytes.Take();
}

}  // namespace

Result<std::string> ColmapZip(const SparseModel& model) {
  return WriteZip({{"cameras.txt", CamerasText(model.camera)},
                   {"images.txt", ImagesText(model)},
                   {"points3D.txt", PointsText(model)},
                   {"cameras.bin", CamerasBinary(model.camera)},
                   {"images.bin", ImagesBinary(model)},
                   {"points3D.bin", PointsBinary(model)}});
}

}  // namespace drupe
