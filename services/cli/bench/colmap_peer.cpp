#include "cli/bench/colmap_peer.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <sstream>

#include "base/files.h"
#include "cli/bench/neighbour_pairs.h"
#include "cli/bench/peer_steps.h"

namespace drupe {

namespace {

/// Runs a command of COLMAP; its CPU seconds.
Result<double> RunCommand(PeerSteps& steps, const std::string& command, std::vector<std::string> arguments) {
  arguments.insert(arguments.begin(), {"colmap", command});
  return steps.Run(command, arguments);
}

/// "a.jpg b.jpg" lines.
std::string PairList(const std::vector<SourceImage>& images, int window) {
  std::string text;
  for (const ImagePair& pair : NeighbourPairs(static_cast<int>(images.size()), window)) {
    text += images[pair.first].name + " " + images[pair.second].name + "\n";
  }
  return text;
}

Result<double> Match(const TruthSet& set, const ColmapPairs& pairs, const std::string& directory,
                     const std::string& database, PeerSteps& colmap) {
  if (pairs.exhaustive) {
    return RunCommand(colmap, "exhaustive_matcher", {"--database_path", database, "--SiftMatching.use_gpu", "0"});
  }
  const std::string list = directory + "/pairs.txt";
  DRUPE_RETURN_IF_ERROR(WriteFileAtomically(list, PairList(set.input.images, pairs.window)));
  return RunCommand(
      colmap, "matches_importer",
      {"--database_path", database, "--match_list_path", list, "--match_type", "pairs", "--SiftMatching.use_gpu", "0"});
}

/// Reads the model with most pictures of those that the mapper left in numbered directories.
Status ReadLargestModel(const std::string& models, const std::string& directory, PeerSteps& colmap, SfmRun& run) {
  std::vector<std::filesystem::path> found;
  for (const auto& entry : std::filesystem::directory_iterator(models)) found.push_back(entry.path());
  std::sort(found.begin(), found.end());
  for (const std::filesystem::path& model : found) {
    const std::string text = directory + "/text-" + model.filename().string();
    std::filesystem::create_directories(text);
    DRUPE_RETURN_IF_ERROR(RunCommand(colmap, "model_converter",
                                     {"--input_path", model.string(), "--output_path", text, "--output_type", "TXT"})
                              .status());
    DRUPE_ASSIGN_OR_RETURN(const std::string images, ReadFile(text + "/images.txt"));
    DRUPE_ASSIGN_OR_RETURN(std::vector<View> views, ParseColmapImages(images));
    if (views.size() <= run.views.size()) continue;
    run.views = std::move(views);
    DRUPE_ASSIGN_OR_RETURN(const std::string points, ReadFile(text + "/points3D.txt"));
    run.points = CountColmapPoints(points);
  }
  return Status::Ok();
}

}  // namespace

ColmapCamera ColmapCameraOf(const PinholeCamera& camera) {
  const auto& d = camera.dist;
  char text[400];
  std::snprintf(text, sizeof text, "%.12g,%.12g,%.12g,%.12g,%.12g,%.12g,%.12g,%.12g", camera.fx, camera.fy,
                camera.cx + 0.5, camera.cy + 0.5, d[0], d[1], d[2], d[3]);
  if (d[4] == 0) return {"OPENCV", text};
  char third[40];
  std::snprintf(third, sizeof third, ",%.12g,0,0,0", d[4]);
  return {"FULL_OPENCV", std::string(text) + third};
}

Result<std::vector<View>> ParseColmapImages(const std::string& text) {
  std::vector<View> views;
  std::istringstream lines(text);
  for (std::string line; std::getline(lines, line);) {
    if (line.empty() || line[0] == '#') continue;
    std::istringstream words(line);
    long id = 0, camera = 0;
    double w = 1, x = 0, y = 0, z = 0;
    Rigid3 pose;
    View view;
    words >> id >> w >> x >> y >> z >> pose.translation.x() >> pose.translation.y() >> pose.translation.z() >> camera >>
        view.image;
    if (!words) return Unprocessable("bad_peer_model", "images.txt: not an image: " + line.substr(0, 80));
    pose.rotation = Eigen::Quaterniond(w, x, y, z).normalized().toRotationMatrix();
    view.cam_from_world = pose;
    views.push_back(std::move(view));
    std::getline(lines, line);  // what it sees, possibly nothing
  }
  return views;
}

std::size_t CountColmapPoints(const std::string& text) {
  std::size_t count = 0;
  std::istringstream lines(text);
  for (std::string line; std::getline(lines, line);) count += !line.empty() && line[0] != '#' ? 1 : 0;
  return count;
}

Result<SfmRun> RunColmap(const TruthSet& set, const ColmapPairs& pairs, const std::string& directory) {
  const std::string database = directory + "/database.db", images = set.directory + "/images";
  const std::string models = directory + "/models";
  std::filesystem::create_directories(models);
  const ColmapCamera camera = ColmapCameraOf(set.input.calibration->camera);
  PeerSteps colmap(directory);
  SfmRun run;
  run.method = pairs.exhaustive ? "COLMAP, all pairs" : "COLMAP, pairs within " + std::to_string(pairs.window);
  DRUPE_ASSIGN_OR_RETURN(run.features_cpu_s,
                         RunCommand(colmap, "feature_extractor",
                                    {"--database_path", database, "--image_path", images, "--ImageReader.single_camera",
                                     "1", "--ImageReader.camera_model", camera.model, "--ImageReader.camera_params",
                                     camera.parameters, "--SiftExtraction.use_gpu", "0"}));
  DRUPE_ASSIGN_OR_RETURN(run.matching_cpu_s, Match(set, pairs, directory, database, colmap));
  DRUPE_ASSIGN_OR_RETURN(run.poses_cpu_s,
                         RunCommand(colmap, "mapper",
                                    {"--database_path", database, "--image_path", images, "--output_path", models,
                                     "--Mapper.ba_refine_focal_length", "0", "--Mapper.ba_refine_extra_params", "0"}));
  run.all_cpu_s = run.features_cpu_s + run.matching_cpu_s + run.poses_cpu_s;
  run.wall_s = colmap.wall_s();
  DRUPE_RETURN_IF_ERROR(ReadLargestModel(models, directory, colmap, run));
  return run;
}

}  // namespace drupe
