#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <thread>
#include <vector>

#include "base/status.h"
#include "http/service.h"
#include "jobs/change_signal.h"
#include "service/service_stores.h"

namespace drupe {

struct StoreKeeperOptions {
  std::string owner = "";               ///< the service's name, for ObjectStore::KeepRoots
  std::vector<std::string> kinds = {};  ///< of jobs that are forgotten once they are old; empty: of none
  std::int64_t retain_ms = 0;           ///< after their end; 0: never
  std::int64_t gc_interval_ms = 0;      ///< between collections; 0: none
  std::int64_t gc_min_age_ms = 0;       ///< that an object stays at least
};

/// The options of a service's process.
StoreKeeperOptions KeeperOptions(const ServiceOptions& options, const std::string& owner,
                                 std::vector<std::string> kinds);

/// Keeps a service's stores from growing for ever, on a thread of its own: forgets old jobs, tells the object store
/// what the service refers to, and, where the objects are on this machine's disk, removes those that no service refers
/// to. What another service has not yet said counts from when it spoke last: nothing newer than that, less the minimum
/// age, is ever removed.
class StoreKeeper {
 public:
  /// Forgets what a service itself keeps of jobs that are gone; entries made since `before_ms` stay.
  using Forget = std::function<Status(std::int64_t before_ms)>;

  /// `stores` must outlive the keeper. `forget` may be empty.
  StoreKeeper(ServiceStores& stores, StoreKeeperOptions options, Forget forget = nullptr)
      : stores_(stores), options_(std::move(options)), forget_(std::move(forget)) {}
  ~StoreKeeper() { Stop(); }
  StoreKeeper(const StoreKeeper&) = delete;
  StoreKeeper& operator=(const StoreKeeper&) = delete;

  /// Tells the store at once what the service refers to, and goes on from time to time.
  void Start();
  void Stop();
  /// One round.
  Status KeepOnce();

 private:
  Status ForgetOld();
  Status TellRoots();
  Status Collect();
  void Loop();

  ServiceStores& stores_;
  const StoreKeeperOptions options_;
  const Forget forget_;
  ChangeSignal stopped_;
  std::thread thread_;
};

}  // namespace drupe
