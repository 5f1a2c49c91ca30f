#include "jobs/change_signal.h"

namespace drupe {

std::uint64_t ChangeSignal::version() const {
  const std::lock_guard lock(mutex_);
  return version_;
}

void ChangeSignal::Notify() {
  {
    const std::lock_guard lock(mutex_);
    ++version_;
  }
  changed_.notify_all();
}

std::uint64_t ChangeSignal::WaitBeyond(std::uint64_t seen, std::chrono::milliseconds timeout) const {
  std::unique_lock lock(mutex_);
  changed_.wait_for(lock, timeout, [&] { return version_ > seen; });
  return version_;
}

}  // namespace drupe
