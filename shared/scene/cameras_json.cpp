#include "scene/cameras_json.h"

#include <Eigen/LU>
#include <cmath>
#include <optional>
#include <string>

#include "base/limits.h"
#include "scene/calibration.h"

namespace drupe {
namespace {

constexpr const char* kIntrinsicsNames[] = {"given", "exif", "estimated"};

Json RotationJson(const Eigen::Matrix3d& rotation) {
  Json rows = Json::array();
  for (int i = 0; i < 3; ++i) rows.push_back({rotation(i, 0), rotation(i, 1), rotation(i, 2)});
  return rows;
}

Json ViewJson(const View& view) {
  Json json;
  json["image"] = view.image;
  json["registered"] = view.cam_from_world.has_value();
  if (view.cam_from_world) {
    const Eigen::Vector3d& t = view.cam_from_world->translation;
    json["R"] = RotationJson(view.cam_from_world->rotation);
    json["t"] = {t.x(), t.y(), t.z()};
    json["mean_reprojection_error_px"] = view.mean_reprojection_error_px;
    json["observations"] = view.observation_count;
    if (view.centre_sigma > 0) json["centre_sigma"] = view.centre_sigma;
    if (view.rotation_sigma_deg > 0) json["rotation_sigma_deg"] = view.rotation_sigma_deg;
  } else {
    json["R"] = nullptr;
    json["t"] = nullptr;
    json["reason"] = view.reason;
  }
  return json;
}

Status InvalidCameras(std::string message, std::string field) {
  return InvalidArgument("invalid_cameras", std::move(message), std::move(field));
}

/// Reads exactly `count` finite numbers.
void ReadIfNumber(const Json& json, const char* key, double& value) {
  if (json.contains(key) && json[key].is_number()) value = json[key].get<double>();
}

bool ReadRotation(const Json& json, Eigen::Matrix3d& rotation) {
  if (!json.is_array() || json.size() != 3) return false;
  for (int i = 0; i < 3; ++i) {
    double row[3];
    if (!ReadNumbers(json[static_cast<std::size_t>(i)], row)) return false;
    rotation.row(i) = Eigen::RowVector3d(row[0], row[1], row[2]);
  }
  const bool is_orthonormal = (rotation * rotation.transpose() - Eigen::Matrix3d::Identity()).norm() < 1e-6;
  return is_orthonormal && rotation.determinant() > 0;
}

Result<View> ParseView(const Json& json, const std::string& field) {
  if (!json.is_object() || !json.contains("image") || !json["image"].is_string()) {
    return InvalidCameras("must have the image's name", field + ".image");
  }
  View view;
  view.image = json["image"].get<std::string>();
  view.reason = json.contains("reason") && json["reason"].is_string() ? json["reason"].get<std::string>() : "";
  if (!json.contains("R") || json["R"].is_null()) return view;
  Rigid3 pose;
  if (!ReadRotation(json["R"], pose.rotation)) return InvalidCameras("must be a 3x3 rotation", field + ".R");
  double t[3];
  if (!json.contains("t") || !ReadNumbers(json["t"], t))
    return InvalidCameras("must have 3 finite numbers", field + ".t");
  pose.translation = Eigen::Vector3d(t[0], t[1], t[2]);
  view.cam_from_world = pose;
  ReadIfNumber(json, "mean_reprojection_error_px", view.mean_reprojection_error_px);
  ReadIfNumber(json, "centre_sigma", view.centre_sigma);
  ReadIfNumber(json, "rotation_sigma_deg", view.rotation_sigma_deg);
  return view;
}

Status ReadSources(const Json& json, SparseModel& model) {
  const auto scale = json.find("scale_source");
  if (scale == json.end() || (*scale != "board" && *scale != "none")) {
    return InvalidCameras("must be \"board\" or \"none\"", "scale_source");
  }
  model.scale_source = *scale == "board" ? ScaleSource::kBoard : ScaleSource::kNone;
  const auto intrinsics = json.find("intrinsics_source");
  if (intrinsics == json.end()) return Status::Ok();
  for (int i = 0; i < 3; ++i) {
    if (*intrinsics != kIntrinsicsNames[i]) continue;
    model.intrinsics_source = static_cast<IntrinsicsSource>(i);
    return Status::Ok();
  }
  return InvalidCameras("must be \"given\", \"exif\" or \"estimated\"", "intrinsics_source");
}

}  // namespace

Json CamerasJson(const SparseModel& model) {
  const bool is_metric = model.scale_source == ScaleSource::kBoard;
  Json json;
  json["unit"] = is_metric ? "mm" : "arbitrary";
  json["frame"] = is_metric ? "board" : "first_view";
  json["scale_source"] = is_metric ? "board" : "none";
  json["intrinsics_source"] = kIntrinsicsNames[static_cast<int>(model.intrinsics_source)];
  json["calibration"] = ToJson(Calibration{model.camera, 0});
  json["registered"] = model.RegisteredCount();
  json["of"] = model.views.size();
  json["points"] = model.tracks.size();
  json["mean_reprojection_error_px"] = model.mean_reprojection_error_px;
  if (is_metric) {
    json["board_rms_px"] = model.board_rms_px;
    json["board_observations"] = model.board_observations;
    json["scale_relative_sigma"] = model.scale_relative_sigma;
  }
  json["cameras"] = Json::array();
  for (const View& view : model.views) json["cameras"].push_back(ViewJson(view));
  return json;
}

Result<SparseModel> ParseCameras(const Json& json) {
  if (!json.is_object()) return InvalidCameras("must be an object", "");
  SparseModel model;
  DRUPE_RETURN_IF_ERROR(ReadSources(json, model));
  const auto calibration = json.find("calibration");
  if (calibration == json.end()) return InvalidCameras("must be a calibration", "calibration");
  DRUPE_ASSIGN_OR_RETURN(const Calibration read, ParseCalibration(*calibration));
  model.camera = read.camera;
  const auto cameras = json.find("cameras");
  const std::size_t limit = static_cast<std::size_t>(Limits{}.max_images);
  if (cameras == json.end() || !cameras->is_array() || cameras->size() > limit) {
    return InvalidCameras("must be a list of at most " + std::to_string(limit) + " cameras", "cameras");
  }
  for (std::size_t i = 0; i < cameras->size(); ++i) {
    DRUPE_ASSIGN_OR_RETURN(View view, ParseView((*cameras)[i], "cameras." + std::to_string(i)));
    model.views.push_back(std::move(view));
  }
  return model;
}

}  // namespace drupe
