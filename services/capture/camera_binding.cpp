#include "capture/camera_binding.h"

#include "base/option_reader.h"

namespace drupe {
namespace {

constexpr std::size_t kMaxBytes = 128;

Status Mismatch(const char* code, const char* what, const std::string& calibrated, const std::string& used) {
  return {StatusKind::kUnprocessable, code,
          std::string("the calibration was made with ") + what + " " + calibrated + ", and this is " + used,
          "calibration"};
}

bool Differ(const std::string& a, const std::string& b) {
  return !a.empty() && !b.empty() && a != b;
}

}  // namespace

Result<CameraBinding> ParseCameraBinding(const Json& json) {
  if (!json.is_object()) return InvalidArgument("invalid_option", "camera must be an object", "camera");
  Json known = Json::object();
  for (const auto& [key, value] : json.items()) {
    if (!value.is_null()) known[key] = value;
  }
  CameraBinding binding;
  OptionReader reader(known, "camera");
  reader.Read("serial", binding.serial);
  reader.Read("lens", binding.lens);
  DRUPE_RETURN_IF_ERROR(reader.Finish());
  if (binding.serial.size() <= kMaxBytes && binding.lens.size() <= kMaxBytes) return binding;
  return InvalidArgument("invalid_option", "serial and lens may have 128 characters", "camera");
}

Json ToJson(const CameraBinding& binding) {
  const auto text = [](const std::string& value) { return value.empty() ? Json() : Json(value); };
  return {{"serial", text(binding.serial)}, {"lens", text(binding.lens)}};
}

Status CheckBinding(const CameraBinding& calibration, const CameraBinding& used) {
  if (Differ(calibration.serial, used.serial)) {
    return Mismatch("calibration_camera_mismatch", "the camera", calibration.serial, used.serial);
  }
  if (Differ(calibration.lens, used.lens)) {
    return Mismatch("calibration_lens_mismatch", "the lens at", calibration.lens, used.lens);
  }
  return Status::Ok();
}

}  // namespace drupe
