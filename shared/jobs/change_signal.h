#pragma once

#include <chrono>
#include <condition_variable>
#include <cstdint>
#include <mutex>

namespace drupe {

/// A counter one can wait for, so that event streams and idle workers sleep until something changed instead of polling.
///
///   std::uint64_t seen = signal.version();       // before looking
///   ... look at the jobs ...
///   seen = signal.WaitBeyond(seen, 10s);         // returns at once if something changed since
class ChangeSignal {
 public:
  std::uint64_t version() const;
  /// Wakes all waiters.
  void Notify();
  /// Returns the version once it is greater than `seen`, or the present one after `timeout`.
  std::uint64_t WaitBeyond(std::uint64_t seen, std::chrono::milliseconds timeout) const;

 private:
  mutable std::mutex mutex_;
  mutable std::condition_variable changed_;
  std::uint64_t version_ = 0;
};

}  // namespace drupe
