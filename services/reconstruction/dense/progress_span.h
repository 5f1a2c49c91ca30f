#pragma once

#include <mutex>

#include "base/run_context.h"

namespace drupe::dense {

/// The stage's progress when the points are there and colouring begins.
constexpr double kAssembledShare = 0.88;

/// Reports a part of the stage "dense" as its work gets done: from any thread, one call at a time, in steps of half a
/// percent of the stage.
class ProgressSpan {
 public:
  /// The part from `from` to `to` (0..1), for `total` units of work.
  ProgressSpan(const RunContext& run, double from, double to, double total);

  void Add(double units);

 private:
  const RunContext& run_;
  double from_, to_, total_;
  std::mutex mutex_;
  double done_ = 0, reported_ = 0;
};

}  // namespace drupe::dense
