#pragma once

#include <initializer_list>
#include <string>
#include <string_view>
#include <utility>

#include "base/json.h"

namespace drupe {

enum class LogLevel { kDebug, kInfo, kWarning, kError };

/// Sets up logging for the process: one JSON object a line on stderr ({"time", "level", "service", "message", fields}).
/// Without it (unit tests, the command line), only warnings and errors are written, as plain text.
void InitJsonLog(std::string_view service, LogLevel minimum);

/// Writes one line. `fields` are added to it: Log(LogLevel::kInfo, "job done", {{"job", id}, {"wall_s", 3.2}}).
void Log(LogLevel level, std::string_view message,
         std::initializer_list<std::pair<std::string_view, Json>> fields = {});

}  // namespace drupe
