#pragma once

#include <atomic>
#include <functional>
#include <memory>
#include <set>
#include <string>
#include <thread>
#include <vector>

#include "base/json.h"
#include "base/status.h"
#include "http/service.h"
#include "jobs/job_runner.h"
#include "jobs/job_store.h"
#include "jobs/sql/database.h"

namespace drupe {

/// The jobs that are calls.
inline constexpr const char* kWebhookKind = "webhook";

struct WebhookOptions {
  std::string secret;                   ///< that bodies are signed with; empty: no webhooks
  std::set<std::string> allowed_hosts;  ///< that may be called though their addresses are private
};

/// Reads --webhook-secret and --webhook-allow. Errors: those of ReadFile; 400 `invalid_option` for a secret of fewer
/// than 16 characters.
Result<WebhookOptions> ReadWebhookOptions(const ServiceOptions& options);

/// The value of the header Drupe-Signature: "t=SECONDS,v1=HEX", HEX being HMAC-SHA256 under the secret of
/// "SECONDS.BODY", so that a body can neither be forged nor sent again later.
std::string WebhookSignature(const std::string& secret, std::int64_t unix_s, const std::string& body);

/// Calls a URL that came with a job when the job has ended. Which URLs are to be called is a table of the service's
/// database; each call is a job of kind "webhook", so that it is tried again with growing pauses, outlives a restart,
/// and shows its failures under /jobs. A job that is retried by hand and ends again is told again. Thread-safe.
class Webhooks {
 public:
  /// What is said of a job: "event" and whatever the service adds.
  using Describe = std::function<Json(const Job&)>;

  /// Everything outlives the webhooks.
  static Result<std::unique_ptr<Webhooks>> Open(Database& database, JobStore& jobs, WebhookOptions options,
                                                Describe describe);
  ~Webhooks();

  /// Whether a URL can be given with a job; the name's addresses are looked at when it is called. Errors: 400
  /// `invalid_webhook`, `webhooks_off`, 403 `webhook_refused` for an address that is not public.
  Status Check(const std::string& url) const;
  /// Has `url` called when the job ends, now if it has ended. Another URL for the same job takes its place.
  Status Subscribe(const std::string& job_id, const std::string& url);
  /// Forgets the URLs of jobs that are forgotten.
  Status ForgetGone();

  /// Starts the threads that look for ended jobs and call, in a process that does the work.
  Status Start(const std::string& worker_name);
  void Stop();
  /// Queues the calls that are due; returns how many.
  Result<int> QueueDue();

 private:
  struct Due {
    std::string job, url;
  };

  Webhooks(Database& database, JobStore& jobs, WebhookOptions options, Describe describe)
      : database_(database), jobs_(jobs), options_(std::move(options)), describe_(std::move(describe)) {}

  Result<std::vector<Due>> FindDue();
  Status QueueCall(const Due& due);
  Status MarkTold(const std::string& job_id, std::int64_t finished_ms);
  Result<Json> Call(const Job& job) const;
  void Watch();

  Database& database_;
  JobStore& jobs_;
  const WebhookOptions options_;
  const Describe describe_;
  std::unique_ptr<JobRunner> runner_;
  std::atomic<bool> stopping_{false};
  std::thread watcher_;
};

}  // namespace drupe
