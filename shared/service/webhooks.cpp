#include "service/webhooks.h"

#include <chrono>
#include <ctime>
#include <utility>

#include "base/files.h"
#include "base/hmac.h"
#include "base/log.h"
#include "http/outside_post.h"

namespace drupe {

namespace {

constexpr int kMaxAttempts = 20;  ///< with pauses of up to a minute, a quarter of an hour
constexpr int kJobsAtOnce = 100;
constexpr int kPriority = 5;
constexpr std::size_t kMaxSecretBytes = 4096;
constexpr std::size_t kMinSecretBytes = 16;
constexpr std::chrono::milliseconds kLook{1'000};  ///< for jobs that another process has ended
constexpr std::chrono::milliseconds kPause{100};   ///< between looks, however much changes

// told_ms: the end (finished_ms) of the job that was told last; 0 for none.
const Migrations kSchema = {
    "CREATE TABLE webhooks (job TEXT PRIMARY KEY, url TEXT NOT NULL, told_ms INTEGER NOT NULL) WITHOUT ROWID"};

std::set<std::string> SplitHosts(const std::string& list) {
  std::set<std::string> hosts;
  std::size_t start = 0;
  while (start < list.size()) {
    const std::size_t comma = std::min(list.find(',', start), list.size());
    if (comma > start) hosts.insert(list.substr(start, comma - start));
    start = comma + 1;
  }
  return hosts;
}

bool IsNumericAddress(const std::string& host) {
  return host.find_first_not_of("0123456789.") == std::string::npos || host.find(':') != std::string::npos;
}

}  // namespace

Result<WebhookOptions> ReadWebhookOptions(const ServiceOptions& options) {
  WebhookOptions webhooks{.secret = "", .allowed_hosts = SplitHosts(options.webhook_allow)};
  if (options.webhook_secret.empty()) return webhooks;
  DRUPE_ASSIGN_OR_RETURN(webhooks.secret, ReadFile(options.webhook_secret, kMaxSecretBytes));
  while (!webhooks.secret.empty() && webhooks.secret.back() <= ' ') webhooks.secret.pop_back();
  if (webhooks.secret.size() >= kMinSecretBytes) return webhooks;
  return InvalidArgument("invalid_option", "the secret of webhooks needs 16 characters or more", "webhook_secret");
}

std::string WebhookSignature(const std::string& secret, std::int64_t unix_s, const std::string& body) {
  const std::string time = std::to_string(unix_s);
  return "t=" + time + ",v1=" + HmacSha256Hex(secret, time + "." + body);
}

Result<std::unique_ptr<Webhooks>> Webhooks::Open(Database& database, JobStore& jobs, WebhookOptions options,
                                                 Describe describe) {
  DRUPE_RETURN_IF_ERROR(database.Migrate("webhooks", kSchema));
  return std::unique_ptr<Webhooks>(new Webhooks(database, jobs, std::move(options), std::move(describe)));
}

Webhooks::~Webhooks() {
  Stop();
}

Status Webhooks::Check(const std::string& url) const {
  if (options_.secret.empty()) {
    return InvalidArgument("webhooks_off", "this service calls no webhooks: it has no --webhook-secret", "webhook");
  }
  DRUPE_ASSIGN_OR_RETURN(const OutsideUrl parsed, ParseOutsideUrl(url));
  if (!IsNumericAddress(parsed.host)) return Status::Ok();
  return ResolveOutside(parsed, options_.allowed_hosts).status();
}

Status Webhooks::Subscribe(const std::string& job_id, const std::string& url) {
  const Status kept = database_.Transaction(Durability::kPowerCut, [&]() -> Status {
    DRUPE_ASSIGN_OR_RETURN(const auto insert,
                           database_.Prepare("INSERT INTO webhooks (job, url, told_ms) VALUES (?, ?, 0)"
                                             " ON CONFLICT (job) DO UPDATE SET url = excluded.url"));
    return insert->Bind(job_id).Bind(url).Run();
  });
  if (kept.ok()) jobs_.changes().Notify();
  return kept;
}

Status Webhooks::ForgetGone() {
  return database_.Transaction(Durability::kProcessDeath, [&]() -> Status {
    DRUPE_ASSIGN_OR_RETURN(const auto remove,
                           database_.Prepare("DELETE FROM webhooks WHERE NOT EXISTS (SELECT 1 FROM jobs WHERE "
                                             "jobs.id = webhooks.job)"));
    return remove->Run();
  });
}

Result<std::vector<Webhooks::Due>> Webhooks::FindDue() {
  std::vector<Due> due;
  DRUPE_RETURN_IF_ERROR(database_.Transaction(Durability::kProcessDeath, [&]() -> Status {
    DRUPE_ASSIGN_OR_RETURN(const auto rows,
                           database_.Prepare("SELECT webhooks.job, webhooks.url FROM webhooks"
                                             " JOIN jobs ON jobs.id = webhooks.job WHERE jobs.finished_ms > 0"
                                             " AND jobs.finished_ms <> webhooks.told_ms LIMIT ?"));
    rows->Bind(kJobsAtOnce);
    for (;;) {
      DRUPE_ASSIGN_OR_RETURN(const bool more, rows->Step());
      if (!more) return Status::Ok();
      due.push_back({rows->Text(0), rows->Text(1)});
    }
  }));
  return due;
}

// Its key makes it one call however many processes find it, or find it again after a crash before MarkTold.
Status Webhooks::QueueCall(const Due& due) {
  DRUPE_ASSIGN_OR_RETURN(const Job job, jobs_.Get(due.job));
  if (!IsTerminal(job.state)) return Status::Ok();  // retried a moment ago
  JobSpec spec;
  spec.kind = kWebhookKind;
  spec.id_prefix = "hook";
  spec.subject = job.id;
  spec.payload = {{"url", due.url}, {"body", describe_(job)}};
  spec.priority = kPriority;
  spec.idempotency_key = "webhook:" + job.id + ":" + std::to_string(job.finished_ms);
  spec.max_attempts = kMaxAttempts;
  const Status queued = jobs_.Submit(spec).status();
  // A conflict: the URL was changed after the call had been queued.
  if (!queued.ok() && queued.kind() != StatusKind::kConflict) return queued;
  return MarkTold(job.id, job.finished_ms);
}

Status Webhooks::MarkTold(const std::string& job_id, std::int64_t finished_ms) {
  return database_.Transaction(Durability::kPowerCut, [&]() -> Status {
    DRUPE_ASSIGN_OR_RETURN(const auto update, database_.Prepare("UPDATE webhooks SET told_ms = ? WHERE job = ?"));
    return update->Bind(finished_ms).Bind(job_id).Run();
  });
}

Result<int> Webhooks::QueueDue() {
  DRUPE_ASSIGN_OR_RETURN(const std::vector<Due> due, FindDue());
  for (const Due& one : due) DRUPE_RETURN_IF_ERROR(QueueCall(one));
  return static_cast<int>(due.size());
}

Result<Json> Webhooks::Call(const Job& job) const {
  DRUPE_ASSIGN_OR_RETURN(const OutsideUrl url, ParseOutsideUrl(job.payload.value("url", "")));
  const Json described = job.payload.value("body", Json::object());
  const std::string body = DumpJson(described);
  const std::vector<std::pair<std::string, std::string>> headers = {
      {"Drupe-Event", described.value("event", "")},
      {"Drupe-Delivery", job.id},
      {"Drupe-Signature", WebhookSignature(options_.secret, std::time(nullptr), body)}};
  const Status posted = PostOutside(url, body, headers, {.allowed_hosts = options_.allowed_hosts});
  DRUPE_RETURN_IF_ERROR(posted);
  return Json{{"delivered", true}};
}

Status Webhooks::Start(const std::string& worker_name) {
  if (options_.secret.empty()) return Status::Ok();
  JobRunnerOptions options;
  options.workers = 2;
  options.worker_name = worker_name;
  runner_ = std::make_unique<JobRunner>(jobs_, options);
  runner_->Handle(kWebhookKind, [this](const Job& job, const RunContext&) { return Call(job); });
  DRUPE_RETURN_IF_ERROR(runner_->Start());
  watcher_ = std::thread([this] { Watch(); });
  return Status::Ok();
}

void Webhooks::Watch() {
  while (!stopping_) {
    const std::uint64_t seen = jobs_.changes().version();
    const Result<int> queued = QueueDue();
    if (!queued.ok()) Log(LogLevel::kWarning, "no webhooks queued", {{"error", queued.status().ToString()}});
    std::this_thread::sleep_for(kPause);
    if (!stopping_) jobs_.changes().WaitBeyond(seen, kLook);
  }
}

void Webhooks::Stop() {
  stopping_ = true;
  jobs_.changes().Notify();
  if (watcher_.joinable()) watcher_.join();
  if (runner_) runner_->Stop();
}

}  // namespace drupe
