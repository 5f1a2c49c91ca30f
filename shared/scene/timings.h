#pragma once

#include <string>
#include <vector>

#include "base/clock.h"
#include "base/json.h"

namespace drupe {

/// What one stage of a run cost.
struct StageTiming {
  std::string name;
  double wall_s = 0;
  double cpu_s = 0;    ///< over all threads
  double peak_mb = 0;  ///< peak resident memory of the process up to the stage's end
};

/// The content of timings.json. `sparse_*` count from reading the image files to the metric sparse model.
struct Timings {
  std::vector<StageTiming> stages;
  double sparse_cpu_s = 0, sparse_wall_s = 0;
  double dense_cpu_s = 0, dense_wall_s = 0;
  double analysis_cpu_s = 0, analysis_wall_s = 0;
  double total_wall_s = 0;
  double peak_mb = 0;

  /// Records a stage that `watch` has timed.
  void Add(std::string name, const Stopwatch& watch);
};

Json ToJson(const Timings& timings);

}  // namespace drupe
