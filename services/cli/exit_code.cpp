#include "cli/exit_code.h"

#include <cstdio>

namespace drupe {

int CommandExitCode(const char* command, const Status& status) {
  if (status.ok()) return 0;
  std::fprintf(stderr, "%s: %s\n", command, status.ToString().c_str());
  return 1;
}

}  // namespace drupe
