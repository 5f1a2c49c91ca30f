#include "store/store_usage.h"

#include <string>

#include "store/object_files.h"

namespace drupe {

namespace {

/// What other processes do is seen after this.
constexpr std::chrono::seconds kRecount{60};
/// A full store counts no more often than this, however often it is asked.
constexpr std::chrono::seconds kRecountWhenFull{1};

}  // namespace

Status StoreUsage::Admit(std::uint64_t more) {
  if (quota_ == 0) return Status::Ok();
  const std::lock_guard lock(mutex_);
  const Clock::time_point now = Clock::now();
  const auto is_old = [&](std::chrono::seconds age) {
    return counted_at_ == Clock::time_point() || now - counted_at_ >= age;
  };
  if (is_old(kRecount)) DRUPE_RETURN_IF_ERROR(CountAgain(now));
  const auto fits = [&] { return used_ <= quota_ && quota_ - used_ >= more; };
  if (!fits() && is_old(kRecountWhenFull)) DRUPE_RETURN_IF_ERROR(CountAgain(now));
  if (fits()) return Status::Ok();
  return {StatusKind::kInsufficientStorage, "store_full",
          "the objects have " + std::to_string(used_) + " of the " + std::to_string(quota_) +
              " bytes that they may have together"};
}

void StoreUsage::Add(std::uint64_t bytes) {
  const std::lock_guard lock(mutex_);
  used_ += bytes;
}

Status StoreUsage::CountAgain(Clock::time_point now) {
  DRUPE_ASSIGN_OR_RETURN(const auto objects, ListObjects(directory_, files_));
  used_ = 0;
  for (const auto& [digest, info] : objects) used_ += info.size;
  counted_at_ = now;
  return Status::Ok();
}

}  // namespace drupe
