#pragma once

#include <string>
#include <vector>

#include "base/status.h"

namespace drupe {

/// The programs of a peer, run one after the other with a log each in one directory.
class PeerSteps {
 public:
  /// `directory` must exist.
  explicit PeerSteps(std::string directory) : directory_(std::move(directory)) {}

  /// Runs a command to its end and returns its CPU seconds; its output is in `directory`/`step`.log. Errors: 500
  /// `peer_not_started`, `peer_failed` with the log's place.
  Result<double> Run(const std::string& step, const std::vector<std::string>& command);
  /// Of all steps so far.
  double wall_s() const { return wall_s_; }
  const std::string& directory() const { return directory_; }

 private:
  std::string directory_;
  double wall_s_ = 0;
};

}  // namespace drupe
