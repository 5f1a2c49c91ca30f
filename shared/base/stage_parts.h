#pragma once

#include <cstddef>
#include <functional>
#include <string>
#include <vector>

#include "base/status.h"

namespace drupe {

/// Parts of a stage that know nothing of one another, so that they may be done by other machines.
struct StageParts {
  std::string stage;                                          ///< as RunContext::progress names it
  std::vector<std::string> parts;                             ///< all that another machine must know of each
  std::function<Result<std::string>(std::size_t part)> here;  ///< does one on this machine, which knows it all
  std::function<void(std::size_t part)> done;                 ///< to be called when its result is there
};

/// The results of the parts, in their order.
using RunParts = std::function<Result<std::vector<std::string>>(const StageParts& parts)>;

}  // namespace drupe
