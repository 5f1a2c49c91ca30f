#include "capture/camera/aravis_settings.h"

#include <arv.h>

#include <array>
#include <string>

#include "capture/camera/aravis_handles.h"

namespace drupe {
namespace {

Status SetRegion(ArvCamera* camera, const CameraRegion& region) {
  AravisError error;
  int width = 0, height = 0;
  arv_camera_get_sensor_size(camera, &width, &height, error.out());
  DRUPE_RETURN_IF_ERROR(error.Take("the camera's sensor size"));
  width = region.width > 0 ? region.width : width - region.x;
  height = region.height > 0 ? region.height : height - region.y;
  arv_camera_set_region(camera, region.x, region.y, width, height, error.out());
  DRUPE_RETURN_IF_ERROR(error.Take("the region"));
  int x = 0, y = 0, taken_width = 0, taken_height = 0;
  arv_camera_get_region(camera, &x, &y, &taken_width, &taken_height, error.out());
  DRUPE_RETURN_IF_ERROR(error.Take("the region"));
  if (x == region.x && y == region.y && taken_width == width && taken_height == height) return Status::Ok();
  return Unprocessable("camera_refused", "the camera takes the region " + std::to_string(taken_width) + "x" +
                                             std::to_string(taken_height) + " instead of " + std::to_string(width) +
                                             "x" + std::to_string(height));
}

Status SetPixelFormat(ArvCamera* camera, CameraPixelFormat format) {
  static constexpr std::array kBayer = {"BayerRG8", "BayerGR8", "BayerGB8", "BayerBG8"};
  AravisError error;
  if (format != CameraPixelFormat::kBayer) {
    const char* name = format == CameraPixelFormat::kMono8 ? "Mono8" : "RGB8";
    arv_camera_set_pixel_format_from_string(camera, name, error.out());
    return error.Take(std::string("the pixel format ") + name);
  }
  Status refused;
  for (const char* name : kBayer) {
    arv_camera_set_pixel_format_from_string(camera, name, error.out());
    refused = error.Take(std::string("the pixel format ") + name);
    if (refused.ok() || refused.code() != "camera_refused") return refused;
  }
  return refused;
}

Status SetExposureAndGain(ArvCamera* camera, const CameraOptions& options) {
  AravisError error;
  if (options.exposure_us) arv_camera_set_exposure_time(camera, *options.exposure_us, error.out());
  DRUPE_RETURN_IF_ERROR(error.Take("the exposure"));
  if (options.gain) arv_camera_set_gain(camera, *options.gain, error.out());
  return error.Take("the gain");
}

Status SetTrigger(ArvCamera* camera, const CameraOptions& options) {
  AravisError error;
  arv_camera_set_acquisition_mode(camera, ARV_ACQUISITION_MODE_CONTINUOUS, error.out());
  DRUPE_RETURN_IF_ERROR(error.Take("continuous acquisition"));
  if (options.trigger == CameraTrigger::kFree) {
    arv_camera_clear_triggers(camera, error.out());
    DRUPE_RETURN_IF_ERROR(error.Take("running free"));
    if (options.frame_rate) arv_camera_set_frame_rate(camera, *options.frame_rate, error.out());
    return error.Take("the frame rate");
  }
  const std::string source = options.trigger == CameraTrigger::kSoftware ? "Software" : options.trigger_line;
  arv_camera_set_trigger(camera, source.c_str(), error.out());
  return error.Take("the trigger " + source);
}

Status SetPacketSize(ArvCamera* camera, const CameraOptions& options) {
  if (!arv_camera_is_gv_device(camera)) return Status::Ok();
  AravisError error;
  if (options.packet_bytes > 0) {
    arv_camera_gv_set_packet_size(camera, options.packet_bytes, error.out());
  } else {
    arv_camera_gv_auto_packet_size(camera, error.out());
  }
  return error.Take("the packet size");
}

}  // namespace

Status ApplyCameraOptions(ArvCamera* camera, const CameraOptions& options) {
  DRUPE_RETURN_IF_ERROR(SetPixelFormat(camera, options.pixel_format));
  DRUPE_RETURN_IF_ERROR(SetRegion(camera, options.region));
  DRUPE_RETURN_IF_ERROR(SetExposureAndGain(camera, options));
  DRUPE_RETURN_IF_ERROR(SetTrigger(camera, options));
  return SetPacketSize(camera, options);
}

}  // namespace drupe
