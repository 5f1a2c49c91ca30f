#include "capture/turntable/turntable.h"

namespace drupe {

Status TurntableOptions::Check() const {
  if (!(speed_deg_s >= 0.1 && speed_deg_s <= 360)) {
    return InvalidArgument("invalid_option", "the table's speed must be 0.1 to 360 degrees a second", "speed_deg_s");
  }
  if (settle_ms < 0 || settle_ms > 60'000) {
    return InvalidArgument("invalid_option", "the settle time must be 0 to 60000 ms", "settle_ms");
  }
  return Status::Ok();
}

}  // namespace drupe
