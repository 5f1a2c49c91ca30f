#pragma once

#include <atomic>
#include <cstdint>

#include "base/clock.h"

namespace drupe {

/// For tests: a clock that stands still until it is moved.
class FakeClock : public Clock {
 public:
  std::int64_t NowMs() const override { return now_ms_; }
  void Advance(std::int64_t ms) { now_ms_ += ms; }

 private:
  std::atomic<std::int64_t> now_ms_{1'700'000'000'000};
};

}  // namespace drupe
