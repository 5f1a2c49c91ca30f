#include "capture/hand_over.h"

#include <algorithm>

#include "base/log.h"

namespace drupe {
namespace {

Json Announcement(const ScanRequest& request) {
  Json body = Json::object();
  if (!request.calibration.is_null()) body["calibration"] = request.calibration;
  if (!request.board.is_null()) body["board"] = request.board;
  if (!request.options.empty()) body["options"] = request.options;
  return body;
}

/// Errors that a later attempt may not meet.
bool IsPassing(const Status& status) {
  return status.kind() == StatusKind::kUnavailable || status.kind() == StatusKind::kTooManyRequests ||
         status.kind() == StatusKind::kInternal || status.kind() == StatusKind::kInsufficientStorage;
}

double SecondsSince(std::int64_t then_ms) {
  return static_cast<double>(Clock::System().NowMs() - then_ms) / 1000;
}

std::string TextOf(const Json& json, const char* key) {
  return json.contains(key) && json[key].is_string() ? json[key].get<std::string>() : std::string();
}

/// Stages of a reconstruction that come after the sparse model.
bool IsPastSparse(const std::string& stage) {
  return stage == "dense" || stage == "export" || stage == "artifacts";
}

}  // namespace

Status HandOverOptions::Check() const {
  if (first_retry.count() > 0 && last_retry >= first_retry && watch.count() > 0) return Status::Ok();
  return InvalidArgument("invalid_option", "the retries of the hand-over must be positive and not shrink");
}

HandOver::HandOver(ScanStore& scans, JobStore& jobs, ObjectStore& objects, Client reconstruction,
                   const HandOverOptions& options)
    : scans_(scans), jobs_(jobs), objects_(objects), client_(std::move(reconstruction)), options_(options) {}

HandOver::~HandOver() {
  Stop();
}

void HandOver::Start() {
  thread_ = std::thread([this] { Run(); });
}

void HandOver::Stop() {
  {
    const std::lock_guard lock(mutex_);
    stopping_ = true;
  }
  wake_.notify_all();
  if (thread_.joinable()) thread_.join();
}

void HandOver::Wake() {
  {
    const std::lock_guard lock(mutex_);
    woken_ = true;
  }
  wake_.notify_all();
}

bool HandOver::IsStopping() {
  const std::lock_guard lock(mutex_);
  return stopping_;
}

void HandOver::Run() {
  std::chrono::milliseconds retry = options_.first_retry;
  while (!IsStopping()) {
    const bool watching = PassOver();
    const bool failing = !last_error_.empty();
    retry = failing ? std::min(2 * retry, options_.last_retry) : options_.first_retry;
    std::unique_lock lock(mutex_);
    // A service that is away is not asked again at every frame.
    const auto pause = failing ? retry : watching ? options_.watch : options_.last_retry;
    wake_.wait_for(lock, pause, [&] { return stopping_ || (woken_ && !failing); });
    woken_ = false;
  }
}

bool HandOver::PassOver() {
  const Result<std::vector<std::string>> ids = scans_.Unfinished();
  if (!ids.ok()) {
    Log(LogLevel::kError, "the scans cannot be read", {{"error", ids.status().ToString()}});
    return false;
  }
  for (const std::string& id : *ids) {
    if (IsStopping()) return false;
    NoteError(id, Advance(id));
  }
  return !ids->empty();
}

void HandOver::NoteError(const std::string& id, const Status& status) {
  const std::string text = status.ok() ? "" : status.message();
  std::string& last = last_error_[id];
  if (text != last) {
    if (!text.empty()) Log(LogLevel::kWarning, "a hand-over waits", {{"scan", id}, {"error", status.ToString()}});
    if (const Status saved = scans_.SetHandOverError(id, text); !saved.ok()) return;
  }
  last = text;
  if (text.empty()) last_error_.erase(id);
  if (status.ok() || IsPassing(status)) return;
  // Nothing that waiting helps: the message stays for the user to read.
  if (scans_.SetEnded(id).ok()) last_error_.erase(id);
}

Status HandOver::Advance(const std::string& id) {
  DRUPE_ASSIGN_OR_RETURN(const ScanRecord record, scans_.Get(id));
  const Result<Job> job = jobs_.Get(id);
  if (!job.ok()) return scans_.SetEnded(id);
  DRUPE_ASSIGN_OR_RETURN(const ScanRequest request, ParseScanRequest(job->payload));
  if (job->state == JobState::kCancelled) return scans_.SetEnded(id);
  if (!record.job.empty()) return WatchJob(record, request);
  DRUPE_RETURN_IF_ERROR(SendFrames(record, request));
  if (!record.captured) return Status::Ok();
  return request.reconstruct ? AskForJob(record, request) : scans_.SetEnded(id);
}

Result<std::string> HandOver::EnsureSet(const ScanRecord& record, const ScanRequest& request) {
  if (!record.image_set.empty()) return record.image_set;
  Result<Client::Reply> reply = client_.Post("/image-sets", Announcement(request));
  // An older service takes no announcement.
  if (!reply.ok() && reply.status().code() == "invalid_request") reply = client_.Post("/image-sets", Json::object());
  if (!reply.ok()) return reply.status();
  const std::string set = TextOf(reply->json, "id");
  DRUPE_RETURN_IF_ERROR(scans_.SetImageSet(record.id, set));
  return set;
}

Status HandOver::SendFrames(const ScanRecord& record, const ScanRequest& request) {
  DRUPE_ASSIGN_OR_RETURN(const std::vector<ScanFrame> frames, scans_.Frames(record.id));
  const bool all_sent = std::all_of(frames.begin(), frames.end(), [](const ScanFrame& f) { return f.sent; });
  if (all_sent) return Status::Ok();
  DRUPE_ASSIGN_OR_RETURN(const std::string set, EnsureSet(record, request));
  for (const ScanFrame& frame : frames) {
    if (frame.sent) continue;
    if (IsStopping()) return Status::Ok();
    DRUPE_RETURN_IF_ERROR(SendFrame(record.id, set, frame));
  }
  return Status::Ok();
}

Status HandOver::SendFrame(const std::string& id, const std::string& set, const ScanFrame& frame) {
  DRUPE_ASSIGN_OR_RETURN(const std::string bytes, objects_.Get(frame.sha256));
  const auto reply = client_.Put("/image-sets/" + set + "/images/" + frame.name, bytes, "image/jpeg");
  if (reply.ok()) return scans_.SetSent(id, frame);
  if (reply.status().code() != "image_set_not_found") return reply.status();
  DRUPE_RETURN_IF_ERROR(scans_.SetImageSet(id, ""));  // the service has lost its data: send all again
  return {StatusKind::kUnavailable, "image_set_lost", "the reconstruction service has lost the image set"};
}

Status HandOver::AskForJob(const ScanRecord& record, const ScanRequest& request) {
  DRUPE_ASSIGN_OR_RETURN(const ScanRecord now, scans_.Get(record.id));
  Json body = {{"image_set", now.image_set}, {"analyze", request.analyze}};
  body.update(Announcement(request));
  const auto reply = client_.Post("/reconstruct", body, record.id);
  if (!reply.ok() && reply.status().code() == "image_set_not_found") return scans_.SetImageSet(record.id, "");
  if (!reply.ok()) return reply.status();
  return scans_.SetJob(record.id, TextOf(reply->json, "id"));
}

Status HandOver::WatchJob(ScanRecord record, const ScanRequest& request) {
  DRUPE_ASSIGN_OR_RETURN(const Client::Reply reply, client_.Get("/reconstructions/" + record.job));
  Json timings = record.timings.is_object() ? record.timings : Json::object();
  const std::string state = TextOf(reply.json, "status");
  if (state == "failed" || state == "cancelled") return scans_.SetEnded(record.id);
  const bool succeeded = state == "succeeded";
  const std::size_t noted = timings.size();
  const double seconds = SecondsSince(record.last_shutter_ms);
  if (!timings.contains("sparse_s") && (succeeded || IsPastSparse(TextOf(reply.json, "stage")))) {
    timings["sparse_s"] = seconds;
  }
  if (!timings.contains("reconstruction_s") && succeeded) timings["reconstruction_s"] = seconds;
  if (timings.size() > noted) DRUPE_RETURN_IF_ERROR(scans_.SetTimings(record.id, timings));
  if (!succeeded) return Status::Ok();
  const std::string report = TextOf(reply.json.value("links", Json::object()), "report");
  if (!request.analyze || report.empty()) return scans_.SetEnded(record.id);
  record.timings = std::move(timings);
  return WatchReport(std::move(record), report);
}

Status HandOver::WatchReport(ScanRecord record, const std::string& url) {
  const std::size_t path = url.find('/', url.find("//") + 2);
  if (path == std::string::npos) return scans_.SetEnded(record.id);
  DRUPE_ASSIGN_OR_RETURN(const Client analysis, Client::Create(url.substr(0, path)));
  std::string body;
  const Status status = analysis.Download(url.substr(path), std::uint64_t{64} << 20, [&](std::string_view piece) {
    body.append(piece);
    return true;
  });
  if (status.kind() == StatusKind::kNotFound) return Status::Ok();  // not asked for yet
  DRUPE_RETURN_IF_ERROR(status);
  const Result<Json> report = ParseJson(body, {std::size_t{64} << 20, 64});
  if (!report.ok() || !report->contains("fruits")) return Status::Ok();
  record.timings["report_s"] = SecondsSince(record.last_shutter_ms);
  DRUPE_RETURN_IF_ERROR(scans_.SetTimings(record.id, record.timings));
  return scans_.SetEnded(record.id);
}

}  // namespace drupe
