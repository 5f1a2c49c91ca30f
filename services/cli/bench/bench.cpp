#include "cli/bench/bench.h"

#include <cstdio>

namespace drupe {

int BenchExitCode(const Status& status) {
  if (status.ok()) return 0;
  std::fprintf(stderr, "%s\n", status.message().c_str());
  return 1;
}

}  // namespace drupe
