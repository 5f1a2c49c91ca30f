#pragma once

#include <functional>
#include <string>
#include <vector>

#include "base/run_context.h"
#include "base/status.h"
#include "cli/bench/truth_set.h"

namespace CLI {
class App;
}

namespace drupe {

/// What the user of a bench over sets writes.
struct SetArguments {
  std::vector<std::string> directories;
  int threads = 0;  ///< 0: one a core

  RunContext Context() const;
};

/// Adds SET_DIR..., described by `what_a_set_holds`, and --threads. `arguments` must outlive the parsing.
void AddSetArguments(CLI::App& command, const std::string& what_a_set_holds, SetArguments& arguments);

/// Loads one set after the other and measures it; ends with the first error.
Status MeasureSets(const SetArguments& arguments, const std::function<Status(const TruthSet&)>& measure);

}  // namespace drupe
