#include "capture/camera/aravis_search.h"

#include <arv.h>

#include <algorithm>

namespace drupe {
namespace {

std::string Text(const char* text) {
  return text != nullptr ? text : "";
}

}  // namespace

std::vector<CameraInfo> SearchWithAravis() {
  arv_update_device_list();
  std::vector<CameraInfo> cameras;
  for (unsigned int i = 0; i < arv_get_n_devices(); ++i) {
    cameras.push_back({.id = Text(arv_get_device_id(i)),
                       .model = Text(arv_get_device_model(i)),
                       .serial = Text(arv_get_device_serial_nbr(i)),
                       .vendor = Text(arv_get_device_vendor(i)),
                       .address = Text(arv_get_device_address(i)),
                       .protocol = Text(arv_get_device_protocol(i))});
  }
  std::sort(cameras.begin(), cameras.end(), [](const CameraInfo& a, const CameraInfo& b) { return a.id < b.id; });
  return cameras;
}

}  // namespace drupe
