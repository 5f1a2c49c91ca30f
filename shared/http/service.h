#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <string>

#include "base/limits.h"
#include "base/log.h"
#include "base/status.h"
#include "http/metrics.h"
#include "http/router.h"
#include "http/server.h"

namespace drupe {

/// What a service process does: take requests, do the work, or both.
enum class Role { kApi, kWorker, kBoth };

/// The options that every service has.
struct ServiceOptions {
  std::filesystem::path data = "data";   ///< --data DIR
  Role role = Role::kBoth;               ///< --role api|worker|both
  LogLevel log_level = LogLevel::kInfo;  ///< --log-level debug|info|warning|error
  Limits limits;                         ///< --max-request-mb, --max-image-mb, --max-images, --max-uploads
  ServerOptions server;                  ///< --host, --port
  std::string jobs_url;                  ///< --jobs-url: sqlite:PATH or postgres://...; empty: SQLite in `data`
  std::uint64_t min_free_bytes = std::uint64_t{64} << 20;  ///< --min-free-mb: left free on the disk of the objects
  std::string store_url;  ///< --store-url: file:PATH or http://host:port; empty: DATA/objects
  std::uint64_t store_cache_bytes = std::uint64_t{8} << 30;  ///< --store-cache-bytes: of another machine's objects
  std::uint64_t store_quota_bytes = 0;                       ///< --store-quota-mb; 0: none
  std::string webhook_secret;                                ///< --webhook-secret FILE; empty: no webhooks
  std::string webhook_allow;   ///< --webhook-allow HOST,...: though their address is private
  double retain_days = 0;      ///< --retain-days; 0: for ever
  double gc_interval_min = 0;  ///< --gc-interval-min; 0: never
  double gc_min_age_h = 24;    ///< --gc-min-age-h
  std::string tokens;          ///< --tokens FILE (ReadTokens); needed to listen beyond loopback
  bool open_access = false;    ///< --open-access: listen beyond loopback without tokens
  std::string service_token;   ///< --service-token FILE: what this service shows to the others
  std::string public_url;      ///< --public-url: prefix of links in replies; empty: relative links
};

/// The frame of a service's main(): options (command line, then environment DRUPE_..., then --config FILE), JSON log,
/// /healthz, /readyz, /metrics, /openapi.yaml, /schemas/report.schema.json, and draining on SIGTERM and SIGINT.
///
///   int main(int argc, char** argv) {
///     Service service("drupe-analysis", 8083, "Finds and measures defects.");
///     std::string url = "http://127.0.0.1:8082";
///     service.AddOption("--reconstruction-url", url, "where reconstructions are fetched from");
///     if (std::optional<int> exit_code = service.Parse(argc, argv)) return *exit_code;
///     ... open stores under service.options().data, add routes to service.router() ...
///     service.OnDrain([&] { runner.Stop(); });
///     return service.Run();
///   }
class Service {
 public:
  Service(std::string name, int default_port, std::string description);
  ~Service();

  /// Further options: "--analysis-url" can also be given as DRUPE_ANALYSIS_URL and as "analysis_url" in the config
  /// file.
  void AddOption(const std::string& flag, std::string& value, const std::string& help);
  void AddOption(const std::string& flag, int& value, const std::string& help);
  void AddOption(const std::string& flag, double& value, const std::string& help);
  void AddOption(const std::string& flag, bool& value, const std::string& help);

  /// Reads the options and sets up logging; creates the data directory. An exit code when the process should end: 0
  /// after
  /// --help or --version, 2 for wrong options (explained on stderr), 1 when the directory cannot be made. From here on
  /// SIGTERM and SIGINT are held until Run(), so call it before any thread is started.
  std::optional<int> Parse(int argc, char** argv);

  const ServiceOptions& options() const;
  Router& router();
  Metrics& metrics();

  /// /readyz is 503 while any check gives an error, with its message.
  void AddReadinessCheck(std::string name, std::function<Status()> check);
  /// Called in order of addition when the service drains: first readiness is withdrawn, then `drain` (stop claiming
  /// jobs), then the listener stops once requests under way are answered.
  void OnDrain(std::function<void()> drain);

  /// Serves until a signal comes. Returns the process's exit code: 0 after a drain, 1 when the port is taken.
  int Run();

 private:
  class Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace drupe
