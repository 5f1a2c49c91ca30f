#include "scene/timings.h"

namespace drupe {

void Timings::Add(std::string name, const Stopwatch& watch) {
  stages.push_back({std::move(name), watch.WallSeconds(), watch.CpuSeconds(), ProcessPeakMb()});
}

Json ToJson(const Timings& timings) {
  Json stages = Json::array();
  for (const StageTiming& stage : timings.stages) {
    stages.push_back(
        {{"name", stage.name}, {"wall_s", stage.wall_s}, {"cpu_s", stage.cpu_s}, {"peak_mb", stage.peak_mb}});
  }
  return {{"stages", stages},
          {"sparse_cpu_s", timings.sparse_cpu_s},
          {"sparse_wall_s", timings.sparse_wall_s},
          {"dense_cpu_s", timings.dense_cpu_s},
          {"dense_wall_s", timings.dense_wall_s},
          {"analysis_cpu_s", timings.analysis_cpu_s},
          {"analysis_wall_s", timings.analysis_wall_s},
          {"total_wall_s", timings.total_wall_s},
          {"peak_mb", timings.peak_mb}};
}

}  // namespace drupe
