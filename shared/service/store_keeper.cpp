#include "service/store_keeper.h"

#include <algorithm>
#include <chrono>
#include <set>
#include <utility>

#include "base/clock.h"
#include "base/log.h"
#include "service/references.h"
#include "store/object_roots.h"
#include "store/store_audit.h"

namespace drupe {

namespace {

constexpr std::int64_t kMinuteMs = 60'000;
constexpr std::int64_t kHourMs = 60 * kMinuteMs;
constexpr std::int64_t kDayMs = 24 * kHourMs;
constexpr std::int64_t kNsPerMs = 1'000'000;
constexpr int kForgottenTogether = 500;

}  // namespace

StoreKeeperOptions KeeperOptions(const ServiceOptions& options, const std::string& owner,
                                 std::vector<std::string> kinds) {
  const auto ms = [](double value, std::int64_t unit) {
    return static_cast<std::int64_t>(value * static_cast<double>(unit));
  };
  return {.owner = owner,
          .kinds = std::move(kinds),
          .retain_ms = ms(options.retain_days, kDayMs),
          .gc_interval_ms = ms(options.gc_interval_min, kMinuteMs),
          .gc_min_age_ms = ms(options.gc_min_age_h, kHourMs)};
}

void StoreKeeper::Start() {
  thread_ = std::thread([this] { Loop(); });
}

void StoreKeeper::Stop() {
  stopped_.Notify();
  if (thread_.joinable()) thread_.join();
}

void StoreKeeper::Loop() {
  const std::chrono::milliseconds interval(options_.gc_interval_ms > 0 ? options_.gc_interval_ms : kHourMs);
  for (std::chrono::milliseconds pause(0); stopped_.WaitBeyond(0, pause) == 0; pause = interval) {
    const Status kept = KeepOnce();
    if (!kept.ok()) Log(LogLevel::kWarning, "the stores were not looked after", {{"error", kept.ToString()}});
  }
}

Status StoreKeeper::KeepOnce() {
  if (options_.retain_ms > 0 && !options_.kinds.empty()) DRUPE_RETURN_IF_ERROR(ForgetOld());
  DRUPE_RETURN_IF_ERROR(TellRoots());
  return options_.gc_interval_ms > 0 && stores_.disk != nullptr ? Collect() : Status::Ok();
}

Status StoreKeeper::ForgetOld() {
  const std::int64_t before_ms = stores_.database->clock().NowMs() - options_.retain_ms;
  int forgotten = 0;
  for (int together = kForgottenTogether; together == kForgottenTogether; forgotten += together) {
    DRUPE_ASSIGN_OR_RETURN(together, stores_.jobs->DeleteEndedBefore(before_ms, kForgottenTogether, options_.kinds));
  }
  if (forgotten > 0) Log(LogLevel::kInfo, "forgot old jobs", {{"count", forgotten}});
  return forget_ ? forget_(before_ms) : Status::Ok();
}

Status StoreKeeper::TellRoots() {
  DRUPE_ASSIGN_OR_RETURN(const std::set<std::string> digests, ReferencedDigests(*stores_.database));
  return stores_.objects->KeepRoots(options_.owner, digests);
}

Status StoreKeeper::Collect() {
  const std::filesystem::path& directory = stores_.disk->directory();
  DRUPE_ASSIGN_OR_RETURN(ObjectRoots roots, ReadRoots(directory));
  const std::int64_t since_ns = std::min(Clock::System().NowMs() * kNsPerMs, roots.oldest_ns);
  const GarbageOptions options{.unused_since_ns = since_ns - options_.gc_min_age_ms * kNsPerMs};
  DRUPE_ASSIGN_OR_RETURN(const GarbageReport report, CollectGarbage(directory, std::move(roots.digests), options));
  if (report.removed == 0) return Status::Ok();
  Log(LogLevel::kInfo, "removed objects that nothing refers to",
      {{"removed", report.removed}, {"removed_bytes", report.removed_bytes}, {"kept", report.kept}});
  return Status::Ok();
}

}  // namespace drupe
