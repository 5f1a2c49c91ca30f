#include "cli/bench/truth_set.h"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <map>
#include <numbers>

#include "cli/json_arguments.h"
#include "cli/source_images.h"

namespace drupe {

namespace {

Result<TrueView> ParseTrueView(const Json& json) {
  try {
    TrueView view;
    view.image = json.at("image").get<std::string>();
    for (int row = 0; row < 3; ++row) {
      for (int column = 0; column < 3; ++column) {
        view.cam_from_world.rotation(row, column) = json.at("R").at(row).at(column).get<double>();
      }
      view.cam_from_world.translation[row] = json.at("t").at(row).get<double>();
    }
    return view;
  } catch (const std::exception& error) {
    return InvalidArgument("bad_truth", std::string("truth.json: a view is not {image, R, t}: ") + error.what());
  }
}

Result<ReconstructionInput> LoadInput(const std::string& directory) {
  ReconstructionInput input;
  DRUPE_ASSIGN_OR_RETURN(input.images, LoadSourceImages(directory + "/images", input.limits));
  DRUPE_ASSIGN_OR_RETURN(const Json calibration, LoadJsonArgument(directory + "/calibration.json"));
  DRUPE_ASSIGN_OR_RETURN(input.calibration, ParseCalibration(calibration));
  if (std::filesystem::exists(directory + "/board.json")) {
    DRUPE_ASSIGN_OR_RETURN(input.board, LoadBoardArgument(directory + "/board.json"));
  }
  return input;
}

double RotationAngleDeg(const Eigen::Matrix3d& rotation) {
  return std::acos(std::clamp((rotation.trace() - 1) / 2, -1.0, 1.0)) * 180 / std::numbers::pi;
}

/// Registered views and their true poses, in the order of the set.
struct PosePairs {
  std::vector<Rigid3> truth;
  std::vector<Rigid3> model;
};

PosePairs MatchViews(const TruthSet& set, const std::vector<View>& views) {
  std::map<std::string, const View*> by_name;
  for (const View& view : views) by_name[Stem(view.image)] = &view;
  PosePairs pairs;
  for (const TrueView& view : set.views) {
    const auto found = by_name.find(Stem(view.image));
    if (found == by_name.end() || !found->second->cam_from_world) continue;
    pairs.truth.push_back(view.cam_from_world);
    pairs.model.push_back(*found->second->cam_from_world);
  }
  return pairs;
}

std::vector<Eigen::Vector3d> Centres(const std::vector<Rigid3>& poses) {
  std::vector<Eigen::Vector3d> centres;
  for (const Rigid3& pose : poses) centres.push_back(pose.Centre());
  return centres;
}

}  // namespace

std::string Stem(const std::string& name) {
  return std::filesystem::path(name).stem().string();
}

Result<TruthSet> LoadTruthSet(const std::string& directory) {
  TruthSet set;
  set.directory = directory;
  set.name = std::filesystem::path(directory + "/").parent_path().filename().string();
  DRUPE_ASSIGN_OR_RETURN(set.input, LoadInput(directory));
  DRUPE_ASSIGN_OR_RETURN(set.truth, LoadJsonArgument(directory + "/truth.json"));
  if (!set.truth.contains("views")) return InvalidArgument("bad_truth", "truth.json has no views", "views");
  for (const Json& json : set.truth["views"]) {
    DRUPE_ASSIGN_OR_RETURN(const TrueView view, ParseTrueView(json));
    set.views.push_back(view);
  }
  return set;
}

Result<PoseErrors> ComparePoses(const TruthSet& set, const std::vector<View>& views) {
  const PosePairs pairs = MatchViews(set, views);
  PoseErrors errors;
  errors.registered = static_cast<int>(pairs.model.size());
  errors.of = static_cast<int>(set.views.size());
  const std::vector<Eigen::Vector3d> truth = Centres(pairs.truth);
  const std::vector<Eigen::Vector3d> model = Centres(pairs.model);
  DRUPE_ASSIGN_OR_RETURN(errors.truth_from_model, FitSim3(model, truth));
  for (std::size_t i = 0; i < model.size(); ++i) {
    const double centre = (errors.truth_from_model * model[i] - truth[i]).norm();
    const double rotation = RotationAngleDeg(pairs.model[i].rotation * errors.truth_from_model.rotation.transpose() *
                                             pairs.truth[i].rotation.transpose());
    errors.mean_centre_mm += centre / static_cast<double>(model.size());
    errors.mean_rotation_deg += rotation / static_cast<double>(model.size());
    errors.max_centre_mm = std::max(errors.max_centre_mm, centre);
    errors.max_rotation_deg = std::max(errors.max_rotation_deg, rotation);
  }
  return errors;
}

}  // namespace drupe
