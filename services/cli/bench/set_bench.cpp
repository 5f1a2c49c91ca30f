#include "cli/bench/set_bench.h"

#include <CLI/CLI.hpp>

namespace drupe {

RunContext SetArguments::Context() const {
  RunContext context;
  context.threads = threads;
  return context;
}

void AddSetArguments(CLI::App& command, const std::string& what_a_set_holds, SetArguments& arguments) {
  command.add_option("SET_DIR", arguments.directories, what_a_set_holds)->required();
  command.add_option("--threads", arguments.threads, "Ours: threads; 0: one a core")->check(CLI::Range(0, 1024));
}

Status MeasureSets(const SetArguments& arguments, const std::function<Status(const TruthSet&)>& measure) {
  for (const std::string& directory : arguments.directories) {
    DRUPE_ASSIGN_OR_RETURN(const TruthSet set, LoadTruthSet(directory));
    DRUPE_RETURN_IF_ERROR(measure(set));
  }
  return Status::Ok();
}

}  // namespace drupe
