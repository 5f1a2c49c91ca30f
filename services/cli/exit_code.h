#pragma once

#include "base/status.h"

namespace drupe {

/// The exit code of a command that ended with this status: 0, or 1 with a line on stderr that begins with `command`.
int CommandExitCode(const char* command, const Status& status);

}  // namespace drupe
