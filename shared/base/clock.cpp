#include "base/clock.h"

#include <sys/resource.h>

#include <algorithm>
#include <array>
#include <cstdio>
#include <ctime>

namespace drupe {

namespace {

class SystemClock final : public Clock {
 public:
  std::int64_t NowMs() const override {
    const auto now = std::chrono::system_clock::now().time_since_epoch();
    return std::chrono::duration_cast<std::chrono::milliseconds>(now).count();
  }
};

rusage SelfUsage() {
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  return usage;
}

bool IsDigit(char c) {
  return c >= '0' && c <= '9';
}

/// True when `text` is as `shape`, in which 0 stands for any digit.
bool HasShape(std::string_view text, std::string_view shape) {
  return std::equal(text.begin(), text.end(), shape.begin(), shape.end(),
                    [](char c, char expected) { return expected == '0' ? IsDigit(c) : c == expected; });
}

int Digits(std::string_view text, std::size_t position, std::size_t count) {
  int value = 0;
  for (const char c : text.substr(position, count)) value = value * 10 + (c - '0');
  return value;
}

Status InvalidTime() {
  return InvalidArgument("invalid_time",
                         "a time is written 2026-11-21, 2026-11-21T10:15:30Z or 2026-11-21T10:15:30.123Z (UTC)");
}

}  // namespace

const Clock& Clock::System() {
  static const SystemClock clock;
  return clock;
}

std::string FormatUtc(std::int64_t unix_ms) {
  const std::time_t seconds = static_cast<std::time_t>(unix_ms / 1000);
  std::tm utc{};
  gmtime_r(&seconds, &utc);
  std::array<char, 40> text{};
  const std::size_t length = std::strftime(text.data(), text.size(), "%Y-%m-%dT%H:%M:%S", &utc);
  std::snprintf(text.data() + length, text.size() - length, ".%03dZ", static_cast<int>(unix_ms % 1000));
  return text.data();
}

Result<std::int64_t> ParseUtc(std::string_view text) {
  const bool day_only = HasShape(text, "0000-00-00");
  const bool fraction = HasShape(text, "0000-00-00T00:00:00.000Z");
  if (!day_only && !fraction && !HasShape(text, "0000-00-00T00:00:00Z")) return InvalidTime();
  using namespace std::chrono;
  const year_month_day date{year(Digits(text, 0, 4)), month(static_cast<unsigned>(Digits(text, 5, 2))),
                            day(static_cast<unsigned>(Digits(text, 8, 2)))};
  const int hour = day_only ? 0 : Digits(text, 11, 2);
  const int minute = day_only ? 0 : Digits(text, 14, 2);
  const int second = day_only ? 0 : Digits(text, 17, 2);
  if (!date.ok() || hour > 23 || minute > 59 || second > 59) return InvalidTime();
  const auto time = sys_days(date) + hours(hour) + minutes(minute) + seconds(second) +
                    milliseconds(fraction ? Digits(text, 20, 3) : 0);
  return duration_cast<milliseconds>(time.time_since_epoch()).count();
}

double ProcessCpuSeconds() {
  const rusage usage = SelfUsage();
  const auto seconds = [](const timeval& t) {
    return static_cast<double>(t.tv_sec) + 1e-6 * static_cast<double>(t.tv_usec);
  };
  return seconds(usage.ru_utime) + seconds(usage.ru_stime);
}

double ProcessPeakMb() {
  return static_cast<double>(SelfUsage().ru_maxrss) * 1024.0 / 1e6;
}

Stopwatch::Stopwatch() : wall_start_(std::chrono::steady_clock::now()), cpu_start_(ProcessCpuSeconds()) {}

double Stopwatch::WallSeconds() const {
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - wall_start_).count();
}

double Stopwatch::CpuSeconds() const {
  return ProcessCpuSeconds() - cpu_start_;
}

}  // namespace drupe
