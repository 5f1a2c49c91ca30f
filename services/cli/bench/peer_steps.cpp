#include "cli/bench/peer_steps.h"

#include "cli/bench/peer_process.h"

namespace drupe {

Result<double> PeerSteps::Run(const std::string& step, const std::vector<std::string>& command) {
  const std::string log = directory_ + "/" + step + ".log";
  DRUPE_ASSIGN_OR_RETURN(const PeerRun run, RunPeer(command, log));
  wall_s_ += run.wall_s;
  if (run.exit_code == 0) return run.cpu_s;
  return Internal("peer_failed", command.front() + ", step " + step + ", ended with " + std::to_string(run.exit_code) +
                                     ", see " + log);
}

}  // namespace drupe
