#include "cli/bench/pmvs_peer.h"

#include <cstdio>

#include "base/files.h"
#include "cli/bench/ply_positions.h"

namespace drupe {

namespace {

constexpr std::size_t kMostPlyBytes = std::size_t{1} << 30;

std::string Ppm(const RgbImage& picture) {
  std::string ppm = "P6\n" + std::to_string(picture.width()) + " " + std::to_string(picture.height()) + "\n255\n";
  for (int y = 0; y < picture.height(); ++y) {
    ppm.append(reinterpret_cast<const char*>(picture.Row(y)), static_cast<std::size_t>(picture.width()) * 3);
  }
  return ppm;
}

/// The 3 x 4 matrix from the world to pixels without distortion.
std::string Projection(const PinholeCamera& camera, const Rigid3& cam_from_world) {
  Eigen::Matrix3d k;
  k << camera.fx, 0, camera.cx, 0, camera.fy, camera.cy, 0, 0, 1;
  const Eigen::Matrix3d left = k * cam_from_world.rotation;
  const Eigen::Vector3d right = k * cam_from_world.translation;
  std::string text = "CONTOUR\n";
  for (int row = 0; row < 3; ++row) {
    char line[160];
    std::snprintf(line, sizeof line, "%.12g %.12g %.12g %.12g\n", left(row, 0), left(row, 1), left(row, 2), right[row]);
    text += line;
  }
  return text;
}

Status WriteView(const TruthSet& set, const SparseModel& model, const View& view, const std::string& directory,
                 int number) {
  DRUPE_ASSIGN_OR_RETURN(const RgbImage picture, FlatPicture(set, model, view));
  char name[32];
  std::snprintf(name, sizeof name, "%08d", number);
  DRUPE_RETURN_IF_ERROR(WriteFileAtomically(directory + "/visualize/" + name + ".ppm", Ppm(picture)));
  return WriteFileAtomically(directory + "/txt/" + name + ".txt", Projection(model.camera, *view.cam_from_world));
}

std::string Options(int views, int threads) {
  return "timages -1 0 " + std::to_string(views) +
         "\noimages 0\nlevel 1\ncsize 2\nthreshold 0.7\nwsize 7\nminImageNum 3\nCPU " + std::to_string(threads) +
         "\nuseVisData 0\nsequence -1\nquad 2.5\nmaxAngle 10\n";
}

}  // namespace

Result<PeerCloud> RunPmvs(const TruthSet& set, const SparseModel& model, const std::string& directory, int threads) {
  DRUPE_RETURN_IF_ERROR(MakeFolders(directory, {"visualize", "txt", "models"}));
  int views = 0;
  for (const View& view : model.views) {
    if (view.cam_from_world) DRUPE_RETURN_IF_ERROR(WriteView(set, model, view, directory, views++));
  }
  DRUPE_RETURN_IF_ERROR(WriteFileAtomically(directory + "/option", Options(views, threads)));
  PeerCloud peer;
  const std::string log = directory + "/pmvs2.log";
  DRUPE_ASSIGN_OR_RETURN(peer.run, RunPeer({"pmvs2", directory + "/", "option"}, log));
  const Result<std::string> ply = ReadFile(directory + "/models/option.ply", kMostPlyBytes);
  if (peer.run.exit_code != 0 || !ply.ok()) return Internal("peer_failed", "pmvs2 failed; see " + log);
  DRUPE_ASSIGN_OR_RETURN(peer.cloud, ReadPlyPositions(*ply));
  return peer;
}

}  // namespace drupe
