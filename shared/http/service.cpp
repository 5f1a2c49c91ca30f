#include "http/service.h"

#include <pthread.h>
#include <signal.h>
#include <CLI/CLI.hpp>

#include <atomic>
#include <cctype>
#include <ctime>
#include <iostream>
#include <list>
#include <thread>
#include <utility>
#include <vector>

#include "base/files.h"
#include "base/version.h"
#include "http/client.h"
#include "http/contract_text.h"
#include "http/service_options.h"

namespace drupe {

namespace {

sigset_t DrainSignals() {
  sigset_t signals;
  sigemptyset(&signals);
  sigaddset(&signals, SIGTERM);
  sigaddset(&signals, SIGINT);
  return signals;
}

constexpr std::size_t kMaxTokenFileBytes = 4096;

bool IsLoopback(const std::string& host) {
  return host.starts_with("127.") || host == "::1" || host == "localhost";
}

/// Waits for SIGTERM or SIGINT; 0 once `finished` is true.
int WaitForSignal(const std::atomic<bool>& finished) {
  const sigset_t signals = DrainSignals();
  const timespec slice{0, 100'000'000};
  while (!finished) {
    const int signal = sigtimedwait(&signals, nullptr, &slice);
    if (signal > 0) return signal;
  }
  return 0;
}

}  // namespace

class Service::Impl {
 public:
  Impl(std::string name, int default_port, std::string description)
      : name_(std::move(name)), app_(std::move(description), name_) {
    options_.server.port = default_port;
    AddServiceOptions(app_, options_);
    app_.add_option("--config", config_file_, "JSON file with values for these options")->envname("DRUPE_CONFIG");
    app_.set_version_flag("--version", kVersion);
  }

  template <typename T>
  void AddOption(const std::string& flag, T& value, const std::string& help) {
    app_.add_option(flag, value, help)->capture_default_str()->envname(EnvironmentName(flag));
  }

  std::optional<int> Parse(int argc, char** argv);
  int Run();

  const ServiceOptions& options() const { return options_; }
  Router& router() { return server_->router(); }
  Metrics& metrics() { return metrics_; }

  std::vector<std::pair<std::string, std::function<Status()>>> readiness;
  std::vector<std::function<void()>> drains;

 private:
  Status ReadOptions(int argc, char** argv);
  /// Reads the tokens that callers show, and the one that this process shows.
  Status SetUpAccess();
  void AddCommonRoutes();
  void AnswerReady(Response& response) const;
  void Drain();

  const std::string name_;
  CLI::App app_;
  ServiceOptions options_;
  std::string config_file_;
  Metrics metrics_;
  std::optional<Server> server_;
  std::atomic<bool> draining_{false};
};

Status Service::Impl::ReadOptions(int argc, char** argv) {
  app_.parse(argc, argv);
  if (!config_file_.empty()) DRUPE_RETURN_IF_ERROR(ApplyConfigFile(app_, config_file_));
  options_.server.max_body_bytes = options_.limits.max_request_bytes;
  options_.server.max_concurrent_uploads = options_.limits.max_concurrent_uploads;
  while (options_.public_url.ends_with('/')) options_.public_url.pop_back();
  DRUPE_RETURN_IF_ERROR(SetUpAccess());
  return options_.server.Check();
}

Status Service::Impl::SetUpAccess() {
  if (!options_.service_token.empty()) {
    DRUPE_ASSIGN_OR_RETURN(std::string token, ReadFile(options_.service_token, kMaxTokenFileBytes));
    while (!token.empty() && std::isspace(static_cast<unsigned char>(token.back()))) token.pop_back();
    Client::SetToken(std::move(token));
  }
  if (!options_.tokens.empty()) {
    DRUPE_ASSIGN_OR_RETURN(std::vector<AccessToken> tokens, ReadTokens(options_.tokens));
    options_.server.access = std::make_shared<AccessControl>(std::move(tokens));
    return Status::Ok();
  }
  if (options_.open_access || IsLoopback(options_.server.host)) return Status::Ok();
  return InvalidArgument(
      "tokens_needed",
      "to listen on " + options_.server.host +
          " needs --tokens FILE, or --open-access true where everybody on the network may do everything",
      "tokens");
}

std::optional<int> Service::Impl::Parse(int argc, char** argv) {
  try {
    const Status read = ReadOptions(argc, argv);
    if (!read.ok()) {
      std::cerr << name_ << ": " << read.message() << "\n";
      return 2;
    }
  } catch (const CLI::ParseError& error) {
    return app_.exit(error) == 0 ? 0 : 2;
  }
  InitJsonLog(name_, options_.log_level);
  std::error_code error;
  std::filesystem::create_directories(options_.data, error);
  if (error) {
    Log(LogLevel::kError, "cannot make the data directory",
        {{"path", options_.data.string()}, {"error", error.message()}});
    return 1;
  }
  const sigset_t signals = DrainSignals();
  pthread_sigmask(SIG_BLOCK, &signals, nullptr);
  ::signal(SIGPIPE, SIG_IGN);
  server_.emplace(options_.server, &metrics_);
  AddCommonRoutes();
  return std::nullopt;
}

void Service::Impl::AddCommonRoutes() {
  const RouteOptions open{.max_body_bytes = 0, .scope = Scope::kNone, .reserved = true};
  const RouteOptions reserved{.max_body_bytes = 0, .scope = Scope::kRead, .reserved = true};
  router().Add("GET", "/healthz", open, [this](const Request&, Response& response) {
    response.SetJson({{"status", "ok"}, {"service", name_}, {"version", kVersion}});
  });
  router().Add("GET", "/readyz", open, [this](const Request&, Response& response) { AnswerReady(response); });
  router().Add("GET", "/metrics", reserved, [this](const Request&, Response& response) {
    response.SetText(metrics_.Text(), "text/plain; version=0.0.4");
  });
  router().Add("GET", "/openapi.yaml", open, [](const Request&, Response& response) {
    response.SetText(std::string(kOpenApiText), "application/yaml");
  });
  router().Add("GET", "/schemas/report.schema.json", open, [](const Request&, Response& response) {
    response.SetText(std::string(kReportSchemaText), "application/schema+json");
  });
}

void Service::Impl::AnswerReady(Response& response) const {
  if (draining_) {
    response.SetError(Status(StatusKind::kUnavailable, "draining", "the service is stopping"));
    return;
  }
  for (const auto& [name, check] : readiness) {
    const Status status = check();
    if (status.ok()) continue;
    response.SetError(Status(StatusKind::kUnavailable, status.code(), name + ": " + status.message()));
    return;
  }
  response.SetJson({{"status", "ready"}});
}

void Service::Impl::Drain() {
  draining_ = true;
  for (const std::function<void()>& drain : drains) drain();
  server_->Stop();
}

int Service::Impl::Run() {
  if (const Status bound = server_->Bind(); !bound.ok()) {
    Log(LogLevel::kError, "cannot start", {{"error", bound.ToString()}});
    for (const std::function<void()>& drain : drains) drain();
    return 1;
  }
  Log(LogLevel::kInfo, "serving", {{"host", options_.server.host}, {"port", server_->port()}, {"version", kVersion}});
  std::atomic<bool> finished{false};
  Status served;
  std::thread listener([&] {
    served = server_->Serve();
    finished = true;
  });
  const int signal = WaitForSignal(finished);
  Log(LogLevel::kInfo, "draining", {{"signal", signal}});
  Drain();
  listener.join();
  if (!served.ok()) Log(LogLevel::kError, "stopped", {{"error", served.ToString()}});
  Log(LogLevel::kInfo, "stopped");
  return served.ok() ? 0 : 1;
}

Service::Service(std::string name, int default_port, std::string description)
    : impl_(std::make_unique<Impl>(std::move(name), default_port, std::move(description))) {}
Service::~Service() = default;
void Service::AddOption(const std::string& flag, std::string& value, const std::string& help) {
  impl_->AddOption(flag, value, help);
}
void Service::AddOption(const std::string& flag, int& value, const std::string& help) {
  impl_->AddOption(flag, value, help);
}
void Service::AddOption(const std::string& flag, double& value, const std::string& help) {
  impl_->AddOption(flag, value, help);
}
void Service::AddOption(const std::string& flag, bool& value, const std::string& help) {
  impl_->AddOption(flag, value, help);
}
std::optional<int> Service::Parse(int argc, char** argv) {
  return impl_->Parse(argc, argv);
}
const ServiceOptions& Service::options() const {
  return impl_->options();
}
Router& Service::router() {
  return impl_->router();
}
Metrics& Service::metrics() {
  return impl_->metrics();
}
void Service::AddReadinessCheck(std::string name, std::function<Status()> check) {
  impl_->readiness.emplace_back(std::move(name), std::move(check));
}
void Service::OnDrain(std::function<void()> drain) {
  impl_->drains.push_back(std::move(drain));
}
int Service::Run() {
  return impl_->Run();
}

}  // namespace drupe
