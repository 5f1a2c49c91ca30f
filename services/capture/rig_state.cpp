#include "capture/rig_state.h"

namespace drupe {

void RigState::ShowPreview(std::string_view scan, std::string jpeg) {
  const std::lock_guard lock(mutex_);
  scan_ = scan;
  preview_ = {std::move(jpeg), preview_.number + 1};
}

std::optional<RigState::Preview> RigState::PreviewOf(std::string_view scan, std::int64_t seen) const {
  const std::lock_guard lock(mutex_);
  if (scan_ != scan || preview_.jpeg.empty() || preview_.number <= seen) return std::nullopt;
  return preview_;
}

void RigState::SetTable(Turntable* table) {
  const std::lock_guard lock(mutex_);
  table_ = table;
}

bool RigState::EmergencyStop() {
  const std::lock_guard lock(mutex_);
  if (table_ == nullptr) return false;
  table_->EmergencyStop();
  return true;
}

}  // namespace drupe
