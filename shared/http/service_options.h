#pragma once

#include <string>

#include "base/json.h"
#include "http/service.h"

namespace CLI {
class App;
}

namespace drupe {

/// The environment variable of an option: "--analysis-url" gives "DRUPE_ANALYSIS_URL".
std::string EnvironmentName(const std::string& flag);

/// Adds the options that every service has; `options` must outlive the app.
void AddServiceOptions(CLI::App& app, ServiceOptions& options);

/// Gives every option that neither the command line nor the environment has set its value from a configuration file:
/// {"port": 8082, "analysis_url": "http://..."}. Errors: those of reading and parsing it; 400 `invalid_config` for keys
/// that are no options and for values that are no text, number or boolean. Throws CLI::ParseError for values out of
/// range.
Status ApplyConfigFile(CLI::App& app, const std::string& path);

}  // namespace drupe
