#include "cli/bench/openmvs_peer.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cstdio>
#include <vector>

#include "base/files.h"
#include "cli/bench/ply_positions.h"
#include "image/encode.h"

namespace drupe {

namespace {

constexpr std::size_t kMostMeshBytes = std::size_t{4} << 30;
constexpr double kPixelCentre = 0.5;  ///< of COLMAP's first pixel; ours is at 0

std::string PictureName(std::size_t view) {
  char name[32];
  std::snprintf(name, sizeof name, "%08zu.png", view);
  return name;
}

std::string CamerasText(const PinholeCamera& camera) {
  char line[200];
  std::snprintf(line, sizeof line, "1 PINHOLE %d %d %.12g %.12g %.12g %.12g\n", camera.width, camera.height, camera.fx,
                camera.fy, camera.cx + kPixelCentre, camera.cy + kPixelCentre);
  return line;
}

/// A line of pose and an empty one of observations a view: the tracks name the views that see them.
std::string ImagesText(const SparseModel& model) {
  std::string text;
  for (std::size_t i = 0; i < model.views.size(); ++i) {
    if (!model.views[i].cam_from_world) continue;
    const Rigid3& pose = *model.views[i].cam_from_world;
    const Eigen::Quaterniond q(pose.rotation);
    const Eigen::Vector3d& t = pose.translation;
    char line[300];
    std::snprintf(line, sizeof line, "%zu %.15g %.15g %.15g %.15g %.15g %.15g %.15g 1 %s\n\n", i + 1, q.w(), q.x(),
                  q.y(), q.z(), t.x(), t.y(), t.z(), PictureName(i).c_str());
    text += line;
  }
  return text;
}

std::string PointsText(const SparseModel& model) {
  std::string text;
  for (std::size_t i = 0; i < model.tracks.size(); ++i) {
    const Track& track = model.tracks[i];
    char start[200];
    std::snprintf(start, sizeof start, "%zu %.12g %.12g %.12g %d %d %d %.4g", i + 1, track.position.x(),
                  track.position.y(), track.position.z(), track.colour[0], track.colour[1], track.colour[2],
                  track.mean_reprojection_error_px);
    text += start;
    for (const Observation& seen : track.observations) text += " " + std::to_string(seen.view + 1) + " 0";
    text += "\n";
  }
  return text;
}

Status WriteScene(const TruthSet& set, const SparseModel& model, const std::string& directory) {
  DRUPE_RETURN_IF_ERROR(MakeFolders(directory, {"sparse", "images"}));
  DRUPE_RETURN_IF_ERROR(WriteFileAtomically(directory + "/sparse/cameras.txt", CamerasText(model.camera)));
  DRUPE_RETURN_IF_ERROR(WriteFileAtomically(directory + "/sparse/images.txt", ImagesText(model)));
  DRUPE_RETURN_IF_ERROR(WriteFileAtomically(directory + "/sparse/points3D.txt", PointsText(model)));
  for (std::size_t i = 0; i < model.views.size(); ++i) {
    if (!model.views[i].cam_from_world) continue;
    DRUPE_ASSIGN_OR_RETURN(const RgbImage picture, FlatPicture(set, model, model.views[i]));
    DRUPE_ASSIGN_OR_RETURN(const std::string png, EncodePng(picture));
    DRUPE_RETURN_IF_ERROR(WriteFileAtomically(directory + "/images/" + PictureName(i), png));
  }
  return Status::Ok();
}

/// Runs one of the programs and adds its cost to `sum`.
Status RunStep(const std::vector<std::string>& command, const std::string& directory, PeerRun* sum) {
  const std::string log = directory + "/" + command.front() + ".log";
  DRUPE_ASSIGN_OR_RETURN(const PeerRun run, RunPeer(command, log));
  if (run.exit_code != 0) return Internal("peer_failed", command.front() + " failed; see " + log);
  sum->cpu_s += run.cpu_s;
  sum->wall_s += run.wall_s;
  sum->peak_mb = std::max(sum->peak_mb, run.peak_mb);
  return Status::Ok();
}

}  // namespace

bool HasOpenMvs() {
  return FindProgram("InterfaceCOLMAP") && FindProgram("DensifyPointCloud");
}

Result<PeerCloud> RunOpenMvs(const TruthSet& set, const SparseModel& model, const std::string& directory, int threads) {
  DRUPE_RETURN_IF_ERROR(WriteScene(set, model, directory));
  PeerCloud peer;
  DRUPE_RETURN_IF_ERROR(
      RunStep({"InterfaceCOLMAP", "-w", directory, "-i", ".", "-o", "scene.mvs"}, directory, &peer.run));
  DRUPE_RETURN_IF_ERROR(RunStep({"DensifyPointCloud", "-w", directory, "-i", "scene.mvs", "-o", "scene_dense.mvs",
                                 "--resolution-level", "1", "--max-threads", std::to_string(threads)},
                                directory, &peer.run));
  const Result<std::string> ply = ReadFile(directory + "/scene_dense.ply", kMostMeshBytes);
  if (!ply.ok()) return Internal("peer_failed", "DensifyPointCloud wrote no scene_dense.ply in " + directory);
  DRUPE_ASSIGN_OR_RETURN(peer.cloud, ReadPlyPositions(*ply));
  return peer;
}

}  // namespace drupe
