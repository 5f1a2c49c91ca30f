#pragma once

#include <optional>
#include <string>
#include <vector>

#include "base/status.h"

namespace drupe {

/// What one run of another program cost.
struct PeerRun {
  int exit_code = 0;  ///< 128 + the signal's number when a signal ended it
  double cpu_s = 0;   ///< user and system, of the program and the children it waited for
  double wall_s = 0;
  double peak_mb = 0;  ///< largest resident memory, MB (10^6 bytes)
};

/// The path of a program of that name on PATH; nothing when the machine has none.
std::optional<std::string> FindProgram(const std::string& name);

/// Runs a program to its end, its output written to `log_path`. Nothing is read by a shell. Errors: 500
/// `peer_not_started`.
Result<PeerRun> RunPeer(const std::vector<std::string>& command, const std::string& log_path);

}  // namespace drupe
