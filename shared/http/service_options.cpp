#include "http/service_options.h"

#include <CLI/CLI.hpp>
#include <cctype>
#include <map>

#include "base/files.h"

namespace drupe {

namespace {

constexpr std::size_t kMaxConfigBytes = 1 << 20;

const std::map<std::string, Role> kRoles = {{"api", Role::kApi}, {"worker", Role::kWorker}, {"both", Role::kBoth}};
const std::map<std::string, LogLevel> kLevels = {{"debug", LogLevel::kDebug},
                                                 {"info", LogLevel::kInfo},
                                                 {"warning", LogLevel::kWarning},
                                                 {"error", LogLevel::kError}};

/// An option in units of 2^20 bytes for a limit kept in bytes.
template <typename T>
void AddMegabytes(CLI::App& app, const std::string& flag, T& bytes, const std::string& help) {
  app.add_option_function<double>(
         flag, [&bytes](const double& megabytes) { bytes = static_cast<T>(megabytes * (1 << 20)); }, help)
      ->check(CLI::Range(0.001, 1e6))
      ->default_str(std::to_string(bytes >> 20))
      ->envname(EnvironmentName(flag));
}

void AddStoreOptions(CLI::App& app, ServiceOptions& options) {
  const auto add = [&](const std::string& flag, auto& value, const std::string& help) {
    return app.add_option(flag, value, help)->capture_default_str()->envname(EnvironmentName(flag));
  };
  add("--store-url", options.store_url,
      "where the objects are: file:PATH, or http://HOST:PORT of a service that has them on its disk; without it, in "
      "--data");
  add("--store-cache-bytes", options.store_cache_bytes, "disk space in --data for objects of another machine")
      ->check(CLI::Range(std::uint64_t{1} << 20, std::uint64_t{1} << 50));
  AddMegabytes(app, "--store-quota-mb", options.store_quota_bytes,
               "disk space that all objects may have together: 507 beyond; without it, what the disk holds");
  add("--retain-days", options.retain_days, "forget jobs and image sets this long after their end; 0: never")
      ->check(CLI::Range(0.0, 1e5));
  add("--gc-interval-min", options.gc_interval_min,
      "minutes between removals of objects that nothing refers to; 0: none")
      ->check(CLI::Range(0.0, 1e6));
  add("--gc-min-age-h", options.gc_min_age_h, "hours that every object stays, longer than any job takes")
      ->check(CLI::Range(0.0, 1e5));
}

void AddWebhookOptions(CLI::App& app, ServiceOptions& options) {
  app.add_option("--webhook-secret", options.webhook_secret,
                 "file with the secret that webhooks are signed with; without it there are none")
      ->envname("DRUPE_WEBHOOK_SECRET");
  app.add_option("--webhook-allow", options.webhook_allow,
                 "hosts, with commas between, that webhooks may call although their addresses are private")
      ->envname("DRUPE_WEBHOOK_ALLOW");
}

void AddLimits(CLI::App& app, ServiceOptions& options) {
  AddMegabytes(app, "--max-request-mb", options.limits.max_request_bytes, "largest request body");
  AddMegabytes(app, "--min-free-mb", options.min_free_bytes, "disk space that uploads leave free: 507 beyond");
  AddMegabytes(app, "--max-image-mb", options.limits.max_image_bytes, "largest image file");
  const auto add = [&](const std::string& flag, int& value, int low, int high, const std::string& help) {
    app.add_option(flag, value, help)
        ->check(CLI::Range(low, high))
        ->capture_default_str()
        ->envname(EnvironmentName(flag));
  };
  add("--max-images", options.limits.max_images, 3, 100'000, "most images of a set");
  add("--max-uploads", options.limits.max_concurrent_uploads, 1, 1024, "most uploads at once");
  add("--max-connections", options.server.max_connections, 1, 4096, "most connections served at once");
}

/// A configuration value as the command line would have it.
Result<std::string> ConfigText(const std::string& key, const Json& value) {
  if (value.is_string()) return value.get<std::string>();
  if (value.is_boolean() || value.is_number()) return DumpJson(value);
  return InvalidArgument("invalid_config", "the configuration's \"" + key + "\" must be text, a number or a boolean",
                         key);
}

Status ApplyConfigValue(CLI::App& app, const std::string& key, const Json& value) {
  std::string flag = "--" + key;
  for (char& c : flag) c = c == '_' ? '-' : c;
  CLI::Option* const option = app.get_option_no_throw(flag);
  if (option == nullptr || flag == "--config" || flag == "--help" || flag == "--version") {
    return InvalidArgument("invalid_config", "the configuration's \"" + key + "\" is not an option", key);
  }
  if (option->count() > 0) return Status::Ok();
  DRUPE_ASSIGN_OR_RETURN(const std::string text, ConfigText(key, value));
  option->add_result(text);
  option->run_callback();
  return Status::Ok();
}

}  // namespace

std::string EnvironmentName(const std::string& flag) {
  std::string name = "DRUPE_";
  for (const char c : flag.substr(2)) {
    name.push_back(c == '-' ? '_' : static_cast<char>(std::toupper(static_cast<unsigned char>(c))));
  }
  return name;
}

void AddServiceOptions(CLI::App& app, ServiceOptions& options) {
  app.add_option("--data", options.data, "directory for the job database and the objects")
      ->capture_default_str()
      ->envname("DRUPE_DATA");
  app.add_option("--host", options.server.host, "address to listen on")->capture_default_str()->envname("DRUPE_HOST");
  app.add_option("--port", options.server.port, "port to listen on, 0 for any free one")
      ->check(CLI::Range(0, 65535))
      ->capture_default_str()
      ->envname("DRUPE_PORT");
  app.add_option("--role", options.role, "api (take requests), worker (do the work) or both")
      ->transform(CLI::CheckedTransformer(kRoles))
      ->default_str("both")
      ->envname("DRUPE_ROLE");
  app.add_option("--log-level", options.log_level, "debug, info, warning or error")
      ->transform(CLI::CheckedTransformer(kLevels))
      ->default_str("info")
      ->envname("DRUPE_LOG_LEVEL");
  app.add_option(
         "--jobs-url", options.jobs_url,
         "job database: sqlite:PATH (one process), or postgres://USER@HOST/DATABASE for any number of processes "
         "on any number of machines; without it, SQLite in --data")
      ->envname("DRUPE_JOBS_URL");
  app.add_option(
         "--tokens", options.tokens,
         "JSON file of the tokens that callers must show, each with its scopes; needed to listen beyond loopback")
      ->envname("DRUPE_TOKENS");
  app.add_option("--open-access", options.open_access, "listen beyond loopback without tokens, in a network of friends")
      ->capture_default_str()
      ->envname("DRUPE_OPEN_ACCESS");
  app.add_option("--service-token", options.service_token,
                 "file with the token that this service shows to the other services")
      ->envname("DRUPE_SERVICE_TOKEN");
  app.add_option("--public-url", options.public_url, "put before the links in replies, for a service behind a proxy")
      ->envname("DRUPE_PUBLIC_URL");
  AddLimits(app, options);
  AddStoreOptions(app, options);
  AddWebhookOptions(app, options);
}

Status ApplyConfigFile(CLI::App& app, const std::string& path) {
  DRUPE_ASSIGN_OR_RETURN(const std::string text, ReadFile(path, kMaxConfigBytes));
  DRUPE_ASSIGN_OR_RETURN(const Json config, ParseJson(text));
  if (!config.is_object()) return InvalidArgument("invalid_config", "the configuration must be a JSON object");
  for (const auto& [key, value] : config.items()) DRUPE_RETURN_IF_ERROR(ApplyConfigValue(app, key, value));
  return Status::Ok();
}

}  // namespace drupe
