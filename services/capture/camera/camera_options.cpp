#include "capture/camera/camera_options.h"

#include <algorithm>
#include <array>
#include <utility>

#include "base/option_reader.h"

namespace drupe {
namespace {

constexpr std::size_t kMaxIdBytes = 128;

constexpr int kLargestSide = 16384;
constexpr std::array<std::pair<const char*, CameraPixelFormat>, 3> kFormats = {
    {{"mono8", CameraPixelFormat::kMono8}, {"rgb8", CameraPixelFormat::kRgb8}, {"bayer8", CameraPixelFormat::kBayer}}};

Status Outside(const char* field, const std::string& range) {
  return InvalidArgument("invalid_option", std::string("camera.") + field + " must be " + range,
                         std::string("camera.") + field);
}

Status CheckRange(const std::optional<double>& value, double low, double high, const char* field,
                  const std::string& range) {
  return !value || (*value >= low && *value <= high) ? Status::Ok() : Outside(field, range);
}

void ReadOptional(OptionReader& reader, const Json& json, const char* key, std::optional<double>& value) {
  double number = 0;
  reader.Read(key, number);
  if (json.contains(key)) value = number;
}

Status ReadFormat(OptionReader& reader, CameraPixelFormat& format) {
  std::string name = "bayer8";
  reader.Read("pixel_format", name);
  for (const auto& [known, value] : kFormats) {
    if (name != known) continue;
    format = value;
    return Status::Ok();
  }
  return Outside("pixel_format", "bayer8, mono8 or rgb8");
}

const char* FormatName(CameraPixelFormat format) {
  for (const auto& [name, value] : kFormats) {
    if (value == format) return name;
  }
  return "";
}

}  // namespace

Status CameraOptions::Check() const {
  for (const int value : {region.x, region.y, region.width, region.height}) {
    if (value < 0 || value > kLargestSide) return Outside("region", "within 0 to 16384");
  }
  DRUPE_RETURN_IF_ERROR(CheckRange(exposure_us, 1, 1e7, "exposure_us", "1 to 10000000"));
  DRUPE_RETURN_IF_ERROR(CheckRange(gain, 0, 48, "gain", "0 to 48"));
  DRUPE_RETURN_IF_ERROR(CheckRange(frame_rate, 0.1, 1000, "frame_rate", "0.1 to 1000"));
  if (packet_bytes != 0 && (packet_bytes < 576 || packet_bytes > 16000)) {
    return Outside("packet_bytes", "0 or 576 to 16000");
  }
  if (packet_timeout_ms < 1 || packet_timeout_ms > 1000) return Outside("packet_timeout_ms", "1 to 1000");
  if (frame_timeout_ms < 10 || frame_timeout_ms > 10'000) return Outside("frame_timeout_ms", "10 to 10000");
  if (buffers < 2 || buffers > 64) return Outside("buffers", "2 to 64");
  const bool named = !trigger_line.empty() && trigger_line.size() <= 32 &&
                     std::all_of(trigger_line.begin(), trigger_line.end(),
                                 [](unsigned char c) { return std::isalnum(c) != 0 || c == '_'; });
  return named ? Status::Ok() : Outside("trigger_line", "a name such as Line1");
}

Result<CameraOptions> ParseCameraOptions(const Json& json) {
  CameraOptions options;
  OptionReader reader(json, "camera");
  std::string id;
  reader.Read("id", id);  // names the camera; not an option of it
  DRUPE_RETURN_IF_ERROR(ReadFormat(reader, options.pixel_format));
  ReadOptional(reader, json, "exposure_us", options.exposure_us);
  ReadOptional(reader, json, "gain", options.gain);
  ReadOptional(reader, json, "frame_rate", options.frame_rate);
  reader.Read("trigger_line", options.trigger_line);
  reader.Read("packet_bytes", options.packet_bytes);
  reader.Read("resend", options.resend);
  reader.Read("packet_timeout_ms", options.packet_timeout_ms);
  reader.Read("frame_timeout_ms", options.frame_timeout_ms);
  reader.Read("buffers", options.buffers);
  if (const Json* region = reader.Nested("region")) {
    OptionReader window(*region, reader.PathOf("region"));
    window.Read("x", options.region.x);
    window.Read("y", options.region.y);
    window.Read("width", options.region.width);
    window.Read("height", options.region.height);
    DRUPE_RETURN_IF_ERROR(window.Finish());
  }
  DRUPE_RETURN_IF_ERROR(reader.Finish());
  DRUPE_RETURN_IF_ERROR(options.Check());
  return options;
}

Json ToJson(const CameraOptions& options) {
  const CameraRegion& region = options.region;
  Json json = {{"pixel_format", FormatName(options.pixel_format)},
               {"trigger_line", options.trigger_line},
               {"packet_bytes", options.packet_bytes},
               {"resend", options.resend},
               {"packet_timeout_ms", options.packet_timeout_ms},
               {"frame_timeout_ms", options.frame_timeout_ms},
               {"buffers", options.buffers}};
  if (options.exposure_us) json["exposure_us"] = *options.exposure_us;
  if (options.gain) json["gain"] = *options.gain;
  if (options.frame_rate) json["frame_rate"] = *options.frame_rate;
  json["region"] = {{"x", region.x}, {"y", region.y}, {"width", region.width}, {"height", region.height}};
  return json;
}

Result<CameraChoice> ParseCameraChoice(const Json& json) {
  const auto invalid = [](const char* range) {
    return InvalidArgument("invalid_option", std::string("camera must be ") + range, "camera");
  };
  CameraChoice choice;
  if (json.is_string()) {
    choice.id = json.get<std::string>();
  } else if (json.is_object()) {
    DRUPE_ASSIGN_OR_RETURN(choice.options, ParseCameraOptions(json));
    choice.id = json.value("id", "");
  } else if (!json.is_null()) {
    return invalid("an id or an object");
  }
  if (choice.id.size() > kMaxIdBytes) return invalid("an id of at most 128 characters");
  return choice;
}

Json ToJson(const CameraChoice& choice) {
  Json json = ToJson(choice.options);
  json["id"] = choice.id;
  return json;
}

}  // namespace drupe
