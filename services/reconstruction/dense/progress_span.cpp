#include "reconstruction/dense/progress_span.h"

#include <algorithm>

namespace drupe::dense {

ProgressSpan::ProgressSpan(const RunContext& run, double from, double to, double total)
    : run_(run), from_(from), to_(to), total_(std::max(total, 1.0)), reported_(from) {
  run_.Report("dense", from);
}

void ProgressSpan::Add(double units) {
  constexpr double kStep = 0.005;
  const std::lock_guard lock(mutex_);
  done_ += units;
  const double at = from_ + (to_ - from_) * std::min(done_ / total_, 1.0);
  if (at - reported_ < kStep) return;
  reported_ = at;
  run_.Report("dense", at);
}

}  // namespace drupe::dense
