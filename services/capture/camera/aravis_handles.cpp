#include "capture/camera/aravis_handles.h"

#include <arv.h>

namespace drupe {

AravisError::~AravisError() {
  g_clear_error(&error_);
}

Status AravisError::Take(const std::string& doing) {
  if (error_ == nullptr) return Status::Ok();
  const std::string text = doing + ": " + (error_->message != nullptr ? error_->message : "no reason given");
  const bool device = error_->domain == ARV_DEVICE_ERROR;
  const int code = error_->code;
  g_clear_error(&error_);
  if (device && code == ARV_DEVICE_ERROR_NOT_CONTROLLER) return {StatusKind::kUnavailable, "camera_busy", text};
  const bool gone = device && (code == ARV_DEVICE_ERROR_TIMEOUT || code == ARV_DEVICE_ERROR_NOT_CONNECTED ||
                               code == ARV_DEVICE_ERROR_TRANSFER_ERROR || code == ARV_DEVICE_ERROR_PROTOCOL_ERROR);
  if (gone) return {StatusKind::kUnavailable, "camera_lost", text};
  return Unprocessable("camera_refused", text);
}

}  // namespace drupe
