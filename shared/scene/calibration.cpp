#include "scene/calibration.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <span>
#include <string>

#include "base/limits.h"

namespace drupe {
namespace {

Status InvalidCalibration(std::string message, std::string field) {
  return InvalidArgument("invalid_calibration", std::move(message), std::move(field));
}

Result<int> ReadSide(const Json& json, const char* field) {
  const auto value = json.find(field);
  const int limit = Limits{}.max_image_side_px;
  const auto number = value == json.end() ? std::nullopt : FiniteNumber(*value);
  if (!number || *number < 1 || *number > limit || *number != std::floor(*number)) {
    return InvalidCalibration("must be a whole number of pixels from 1 to " + std::to_string(limit), field);
  }
  return static_cast<int>(*number);
}

Status ReadK(const Json& json, PinholeCamera& camera) {
  const auto rows = json.find("K");
  double k[3][3];
  if (rows == json.end() || !rows->is_array() || rows->size() != 3) return InvalidCalibration("must have 3 rows", "K");
  for (std::size_t i = 0; i < 3; ++i) {
    if (!ReadNumbers((*rows)[i], k[i])) return InvalidCalibration("each row must have 3 finite numbers", "K");
  }
  if (k[0][1] != 0 || k[1][0] != 0 || k[2][0] != 0 || k[2][1] != 0 || k[2][2] != 1) {
    return InvalidCalibration("must be [[fx, 0, cx], [0, fy, cy], [0, 0, 1]]", "K");
  }
  const double longest = std::max(camera.width, camera.height);
  if (!(k[0][0] >= 0.1 * longest && k[1][1] >= 0.1 * longest && std::max(k[0][0], k[1][1]) <= 1000 * longest)) {
    return InvalidCalibration("the focal lengths must be 0.1 to 1000 times the picture's longer side", "K");
  }
  if (!(k[0][2] >= 0 && k[0][2] <= camera.width && k[1][2] >= 0 && k[1][2] <= camera.height)) {
    return InvalidCalibration("the principal point lies outside the picture", "K");
  }
  camera.fx = k[0][0], camera.fy = k[1][1], camera.cx = k[0][2], camera.cy = k[1][2];
  return Status::Ok();
}

/// Radius of the picture's farthest corner in normalised coordinates.
double CornerRadius(const PinholeCamera& camera) {
  const double x = std::max(camera.cx, camera.width - camera.cx) / camera.fx;
  const double y = std::max(camera.cy, camera.height - camera.cy) / camera.fy;
  return std::hypot(x, y);
}

/// True when the lens model maps the picture one to one, which its inversion needs.
bool IsInvertible(const PinholeCamera& camera) {
  const auto [k1, k2, p1, p2, k3] = camera.dist;
  const double corner = CornerRadius(camera);
  if (2 * std::max(std::abs(p1), std::abs(p2)) * corner > 0.1) return false;
  constexpr int kSteps = 64;
  for (int i = 1; i <= kSteps; ++i) {
    const double r2 = std::pow(corner * i / kSteps, 2);
    const double slope = 1 + r2 * (3 * k1 + r2 * (5 * k2 + r2 * 7 * k3));
    if (!(slope > 0.1 && slope < 10)) return false;
  }
  return true;
}

Status ReadDistortion(const Json& json, PinholeCamera& camera) {
  const auto dist = json.find("dist");
  if (dist == json.end()) return Status::Ok();
  if (!ReadNumbers(*dist, camera.dist))
    return InvalidCalibration("must be 5 finite numbers: k1, k2, p1, p2, k3", "dist");
  if (!IsInvertible(camera)) return InvalidCalibration("the distortion folds the picture over itself", "dist");
  return Status::Ok();
}

}  // namespace

Result<Calibration> ParseCalibration(const Json& json) {
  if (!json.is_object()) return InvalidCalibration("the calibration must be a JSON object", "calibration");
  Calibration calibration;
  DRUPE_ASSIGN_OR_RETURN(calibration.camera.width, ReadSide(json, "width"));
  DRUPE_ASSIGN_OR_RETURN(calibration.camera.height, ReadSide(json, "height"));
  DRUPE_RETURN_IF_ERROR(ReadK(json, calibration.camera));
  DRUPE_RETURN_IF_ERROR(ReadDistortion(json, calibration.camera));
  if (const auto rms = json.find("rms_px"); rms != json.end()) {
    const auto number = FiniteNumber(*rms);
    if (!number || *number < 0) return InvalidCalibration("must be a number of at least 0", "rms_px");
    calibration.rms_px = *number;
  }
  return calibration;
}

Json ToJson(const Calibration& calibration) {
  const PinholeCamera& camera = calibration.camera;
  Json k = Json::array({Json::array({camera.fx, 0.0, camera.cx}), Json::array({0.0, camera.fy, camera.cy}),
                        Json::array({0.0, 0.0, 1.0})});
  return {{"width", camera.width},
          {"height", camera.height},
          {"K", std::move(k)},
          {"dist", camera.dist},
          {"rms_px", calibration.rms_px}};
}

Status CheckCalibrationSize(const Calibration& calibration, int width, int height) {
  const PinholeCamera& camera = calibration.camera;
  if (camera.width == width && camera.height == height) return Status::Ok();
  return Unprocessable("calibration_size_mismatch", "the calibration is for pictures of " +
                                                        std::to_string(camera.width) + "x" +
                                                        std::to_string(camera.height) + " pixels, the picture has " +
                                                        std::to_string(width) + "x" + std::to_string(height));
}

}  // namespace drupe
