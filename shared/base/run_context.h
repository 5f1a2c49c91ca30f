#pragma once

#include <cstdint>
#include <functional>
#include <string_view>

#include "base/status.h"

namespace drupe {

/// What a long computation reports and obeys. Stages receive it by const reference; none of them sees a job or HTTP.
struct RunContext {
  /// Called with a stage name ("features", "matching", "sparse", "dense", ...) and the share of that stage done, 0..1.
  /// May be called from any thread, one call at a time per stage; must be cheap. Empty: nobody listens.
  std::function<void(std::string_view stage, double fraction)> progress;
  /// True once the work should stop. Polled at least every 0.5 s of work. Empty: never.
  std::function<bool()> cancelled;
  /// Worker threads; 0 means one per core. The result never depends on it.
  int threads = 0;
  /// Seed of every random choice (RANSAC, k-means), so that the same input gives the same output.
  std::uint64_t seed = 1;

  void Report(std::string_view stage, double fraction) const {
    if (progress) progress(stage, fraction);
  }
  bool IsCancelled() const { return cancelled && cancelled(); }
  /// OK, or the `cancelled` Status once the work should stop.
  Status CheckCancelled() const { return IsCancelled() ? Cancelled() : Status::Ok(); }
  /// The number of threads to use, at least 1.
  int ThreadCount() const;
};

}  // namespace drupe
