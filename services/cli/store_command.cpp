#include <CLI/CLI.hpp>
#include <algorithm>
#include <chrono>
#include <cstdio>
#include <filesystem>
#include <iostream>
#include <memory>
#include <set>
#include <string>
#include <vector>

#include "base/clock.h"
#include "cli/commands.h"
#include "jobs/sql/sql_job_store.h"
#include "service/open_database.h"
#include "service/references.h"
#include "store/object_roots.h"
#include "store/store_audit.h"

namespace drupe {

namespace {

constexpr std::int64_t kHourMs = 3'600'000;
constexpr const char* kServices[] = {"capture", "reconstruction", "analysis"};

struct StoreArguments {
  std::filesystem::path data = "data";
  std::string jobs_url;
  double min_age_h = 24;
  double forget_days = 0;
  bool dry_run = false;

  std::filesystem::path objects() const { return data / "objects"; }
};

int Explain(const Status& status) {
  std::cerr << "drupe store: " << status.message() << "\n";
  return 1;
}

int Check(const StoreArguments& arguments, bool repair) {
  const Result<StoreAudit> audit = CheckObjects(arguments.objects());
  if (!audit.ok()) return Explain(audit.status());
  for (const std::string& digest : audit->damaged) std::printf("damaged   %s\n", digest.c_str());
  for (const std::string& name : audit->misnamed) std::printf("no object %s\n", name.c_str());
  std::printf("%lld objects of %.1f MB are sound, %zu are damaged\n", static_cast<long long>(audit->objects),
              static_cast<double>(audit->bytes) / 1e6, audit->damaged.size());
  if (audit->damaged.empty()) return 0;
  if (!repair) return 1;
  if (const Status moved = SetAside(arguments.objects(), audit->damaged); !moved.ok()) return Explain(moved);
  std::printf("set aside in %s; upload them again, or copy them from a backup\n",
              (arguments.objects() / "damaged").c_str());
  return 0;
}

/// Forgets the old jobs of a service and adds what is left to `roots`.
Status AddRoots(const StoreArguments& arguments, const std::string& service, std::set<std::string>& roots) {
  constexpr int kTogether = 1000;
  DRUPE_ASSIGN_OR_RETURN(const auto database, OpenDatabase(arguments.jobs_url, arguments.data, service));
  if (arguments.forget_days > 0 && !arguments.dry_run) {
    DRUPE_ASSIGN_OR_RETURN(const auto jobs, OpenJobStore(*database));
    const auto before = database->clock().NowMs() - static_cast<std::int64_t>(arguments.forget_days * 24 * kHourMs);
    for (int forgotten = kTogether; forgotten == kTogether;) {
      DRUPE_ASSIGN_OR_RETURN(forgotten, jobs->DeleteEndedBefore(before, kTogether));
    }
  }
  DRUPE_ASSIGN_OR_RETURN(std::set<std::string> digests, ReferencedDigests(*database));
  roots.merge(digests);
  return Status::Ok();
}

// Where a database cannot be read nothing is removed, since what it refers to is not known.
int Collect(const StoreArguments& arguments) {
  std::set<std::string> roots, asked;
  for (const char* service : kServices) {
    const bool exists = std::filesystem::exists(arguments.data / (std::string(service) + ".db"));
    if (arguments.jobs_url.empty() && !exists) continue;
    if (const Status added = AddRoots(arguments, service, roots); !added.ok()) return Explain(added);
    asked.insert(service);
  }
  // Services of other machines that use these objects have said what they refer to.
  Result<ObjectRoots> others = ReadRoots(arguments.objects(), asked);
  if (!others.ok()) return Explain(others.status());
  roots.merge(others->digests);
  const std::int64_t now_ns = Clock::System().NowMs() * 1'000'000;
  const std::int64_t known_ns = others->owners.empty() ? now_ns : std::min(now_ns, others->oldest_ns);
  const auto min_age_ns = static_cast<std::int64_t>(arguments.min_age_h * static_cast<double>(kHourMs) * 1e6);
  const auto report = CollectGarbage(arguments.objects(), std::move(roots),
                                     {.unused_since_ns = known_ns - min_age_ns, .dry_run = arguments.dry_run});
  if (!report.ok()) return Explain(report.status());
  std::printf("%s %lld objects of %.1f MB, kept %lld of %.1f MB\n", arguments.dry_run ? "would remove" : "removed",
              static_cast<long long>(report->removed), static_cast<double>(report->removed_bytes) / 1e6,
              static_cast<long long>(report->kept), static_cast<double>(report->kept_bytes) / 1e6);
  return 0;
}

}  // namespace

void AddStoreCommand(CLI::App& app, int& exit_code) {
  auto arguments = std::make_shared<StoreArguments>();
  CLI::App* const store = app.add_subcommand("store", "look after the objects of the services");
  store->require_subcommand(1);
  const auto add = [&](const char* name, const char* help) {
    CLI::App* const command = store->add_subcommand(name, help);
    command->add_option("--data", arguments->data, "data directory of the services")
        ->capture_default_str()
        ->envname("DRUPE_DATA");
    return command;
  };
  add("check", "compare every object's bytes with its name; exit status 1 when some are damaged")
      ->callback([arguments, &exit_code] { exit_code = Check(*arguments, false); });
  add("repair", "check, and set damaged objects aside")->callback([arguments, &exit_code] {
    exit_code = Check(*arguments, true);
  });
  CLI::App* const gc = add("gc",
                           "remove objects that no job, image set, report or kept JSON object names. With SQLite the "
                           "services must be stopped; with PostgreSQL they may go on");
  gc->add_option("--jobs-url", arguments->jobs_url, "the services' job database; without it, SQLite in --data")
      ->envname("DRUPE_JOBS_URL");
  gc->add_option("--min-age-h", arguments->min_age_h, "younger objects stay")->capture_default_str();
  gc->add_option("--forget-days", arguments->forget_days, "first forget jobs that ended longer ago; 0: none")
      ->capture_default_str();
  gc->add_flag("--dry-run", arguments->dry_run, "say what would be removed");
  gc->callback([arguments, &exit_code] { exit_code = Collect(*arguments); });
}

}  // namespace drupe
