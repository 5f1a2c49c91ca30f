#pragma once

#include <chrono>
#include <cstdint>
#include <string>
#include <string_view>

#include "base/status.h"

namespace drupe {

/// Time as the queues and reports see it; tests replace it.
class Clock {
 public:
  virtual ~Clock() = default;
  /// Milliseconds since 1970-01-01T00:00:00Z.
  virtual std::int64_t NowMs() const = 0;
  /// The machine's clock.
  static const Clock& System();
};

/// "2026-11-21T10:15:30.123Z"
std::string FormatUtc(std::int64_t unix_ms);

/// Reads what FormatUtc writes, with or without the fraction, or a day alone ("2026-11-21"): milliseconds since
/// 1970-01-01T00:00:00Z. Errors: 400 `invalid_time`.
Result<std::int64_t> ParseUtc(std::string_view text);

/// Wall and CPU time since construction, for timings.json. CPU is that of the whole process, over all threads.
class Stopwatch {
 public:
  Stopwatch();
  double WallSeconds() const;
  double CpuSeconds() const;

 private:
  std::chrono::steady_clock::time_point wall_start_;
  double cpu_start_;
};

/// CPU seconds (user and system) of this process so far.
double ProcessCpuSeconds();
/// Peak resident memory of this process so far, in MB (10^6 bytes).
double ProcessPeakMb();

}  // namespace drupe
