#include "cli/bench/openmvg_peer.h"

#include <algorithm>
#include <array>
#include <cstdio>
#include <exception>
#include <filesystem>
#include <map>

#include "base/files.h"
#include "cli/bench/peer_process.h"
#include "cli/bench/peer_steps.h"
#include "cli/json_arguments.h"

namespace drupe {

namespace {

constexpr std::array kPrograms = {"SfMInit_ImageListing", "ComputeFeatures", "PairGenerator",
                                  "ComputeMatches",       "GeometricFilter", "SfM",
                                  "ConvertSfM_DataFormat"};

std::string ProgramOf(const std::string& step) {
  return "openMVG_main_" + step;
}

/// Runs a program of OpenMVG; its CPU seconds.
Result<double> RunStep(PeerSteps& steps, const std::string& step, std::vector<std::string> arguments) {
  arguments.insert(arguments.begin(), ProgramOf(step));
  return steps.Run(step, arguments);
}

/// "f;0;ppx;0;f;ppy;0;0;1"
std::string CalibrationMatrix(const PinholeCamera& camera) {
  const double focal = 0.5 * (camera.fx + camera.fy);
  char text[200];
  std::snprintf(text, sizeof text, "%.12g;0;%.12g;0;%.12g;%.12g;0;0;1", focal, camera.cx, focal, camera.cy);
  return text;
}

Status BadModel(const std::exception& error) {
  return Unprocessable("bad_peer_model", std::string("sfm_data.json is not as expected: ") + error.what());
}

/// The list of pictures with the set's whole lens.
Result<double> ListPictures(const TruthSet& set, const std::string& list, PeerSteps& steps) {
  constexpr const char* kBrown = "4";  // camera model of openMVG_main_SfMInit_ImageListing
  const PinholeCamera& camera = set.input.calibration->camera;
  DRUPE_ASSIGN_OR_RETURN(const double cpu_s, RunStep(steps, "SfMInit_ImageListing",
                                                     {"-i", set.directory + "/images", "-o", steps.directory(), "-k",
                                                      CalibrationMatrix(camera), "-c", kBrown}));
  DRUPE_ASSIGN_OR_RETURN(Json sfm_data, LoadJsonArgument(list));
  DRUPE_RETURN_IF_ERROR(SetOpenMvgLens(camera, sfm_data));
  DRUPE_RETURN_IF_ERROR(WriteFileAtomically(list, sfm_data.dump(1)));
  return cpu_s;
}

Result<double> Match(const std::string& list, PeerSteps& steps) {
  const std::string& directory = steps.directory();
  const std::string pairs = directory + "/pairs.bin", putative = directory + "/matches.putative.bin";
  const std::vector<std::pair<std::string, std::vector<std::string>>> commands = {
      {"PairGenerator", {"-i", list, "-o", pairs, "-m", "EXHAUSTIVE"}},
      {"ComputeMatches", {"-i", list, "-p", pairs, "-o", putative}},
      {"GeometricFilter", {"-i", list, "-m", putative, "-g", "e", "-o", directory + "/matches.e.bin"}}};
  double sum = 0;
  for (const auto& [step, arguments] : commands) {
    DRUPE_ASSIGN_OR_RETURN(const double cpu_s, RunStep(steps, step, arguments));
    sum += cpu_s;
  }
  return sum;
}

Status ReadModel(const std::string& model, PeerSteps& steps, SfmRun& run) {
  const std::string text = steps.directory() + "/model.json";
  DRUPE_RETURN_IF_ERROR(
      RunStep(steps, "ConvertSfM_DataFormat", {"-i", model, "-o", text, "-V", "-I", "-E", "-S"}).status());
  DRUPE_ASSIGN_OR_RETURN(const Json sfm_data, LoadJsonArgument(text));
  DRUPE_ASSIGN_OR_RETURN(run.views, ParseOpenMvgViews(sfm_data));
  run.points = sfm_data.contains("structure") ? sfm_data["structure"].size() : 0;
  return Status::Ok();
}

Rigid3 PoseOf(const Json& json) {
  Rigid3 pose;
  Eigen::Vector3d centre;
  for (int r = 0; r < 3; ++r) {
    for (int c = 0; c < 3; ++c) pose.rotation(r, c) = json.at("rotation").at(r).at(c).get<double>();
    centre[r] = json.at("center").at(r).get<double>();
  }
  pose.translation = -pose.rotation * centre;
  return pose;
}

}  // namespace

bool HasOpenMvg() {
  return std::all_of(kPrograms.begin(), kPrograms.end(),
                     [](const char* step) { return FindProgram(ProgramOf(step)).has_value(); });
}

Status SetOpenMvgLens(const PinholeCamera& camera, Json& sfm_data) {
  const auto& d = camera.dist;  // k1 k2 p1 p2 k3
  try {
    for (Json& intrinsic : sfm_data.at("intrinsics")) {
      Json& value = intrinsic.at("value");
      value.at("ptr_wrapper").at("data").at("disto_t2") = {d[0], d[1], d[4], d[2], d[3]};
    }
  } catch (const std::exception& error) {
    return BadModel(error);
  }
  return Status::Ok();
}

Result<std::vector<View>> ParseOpenMvgViews(const Json& sfm_data) {
  try {
    std::map<long, Rigid3> poses;
    for (const Json& extrinsic : sfm_data.at("extrinsics")) {
      poses[extrinsic.at("key").get<long>()] = PoseOf(extrinsic.at("value"));
    }
    std::vector<View> views;
    for (const Json& json : sfm_data.at("views")) {
      const Json& data = json.at("value").at("ptr_wrapper").at("data");
      View view;
      view.image = data.at("filename").get<std::string>();
      const auto pose = poses.find(data.at("id_pose").get<long>());
      if (pose != poses.end()) view.cam_from_world = pose->second;
      views.push_back(std::move(view));
    }
    return views;
  } catch (const std::exception& error) {
    return BadModel(error);
  }
}

Result<SfmRun> RunOpenMvg(const TruthSet& set, const std::string& directory) {
  const std::string list = directory + "/sfm_data.json", models = directory + "/models";
  std::filesystem::create_directories(models);
  PeerSteps steps(directory);
  SfmRun run;
  run.method = "OpenMVG, all pairs";
  DRUPE_ASSIGN_OR_RETURN(const double listing_cpu_s, ListPictures(set, list, steps));
  DRUPE_ASSIGN_OR_RETURN(run.features_cpu_s,
                         RunStep(steps, "ComputeFeatures", {"-i", list, "-o", directory, "-m", "SIFT"}));
  run.features_cpu_s += listing_cpu_s;
  DRUPE_ASSIGN_OR_RETURN(run.matching_cpu_s, Match(list, steps));
  DRUPE_ASSIGN_OR_RETURN(run.poses_cpu_s, RunStep(steps, "SfM",
                                                  {"-s", "INCREMENTAL", "-i", list, "-m", directory, "-M",
                                                   "matches.e.bin", "-o", models, "-f", "NONE"}));
  run.all_cpu_s = run.features_cpu_s + run.matching_cpu_s + run.poses_cpu_s;
  run.wall_s = steps.wall_s();
  DRUPE_RETURN_IF_ERROR(ReadModel(models + "/sfm_data.bin", steps, run));
  return run;
}

}  // namespace drupe
