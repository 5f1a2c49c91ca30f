#pragma once

#include <chrono>
#include <condition_variable>
#include <map>
#include <mutex>
#include <string>
#include <thread>

#include "base/clock.h"
#include "capture/scan_request.h"
#include "capture/scan_store.h"
#include "http/client.h"
#include "jobs/job_store.h"
#include "store/object_store.h"

namespace drupe {

struct HandOverOptions {
  std::chrono::milliseconds first_retry{500};  ///< after the service could not be reached; doubled each time
  std::chrono::milliseconds last_retry{10'000};
  std::chrono::milliseconds watch{200};  ///< between two looks at a reconstruction that runs

  Status Check() const;
};

/// Hands scans to the reconstruction service while they are taken: the frames into an image set, then the job. What is
/// to be done is read from the ScanStore and what is done is written there, so that nothing is lost or done twice
/// whichever process dies; a name in a set takes one picture, and the job is asked for under the scan's id as
/// Idempotency-Key. While the service is away everything waits on disk. Runs on a thread of its own.
class HandOver {
 public:
  /// All but the options must outlive it.
  HandOver(ScanStore& scans, JobStore& jobs, ObjectStore& objects, Client reconstruction,
           const HandOverOptions& options);
  ~HandOver();
  HandOver(const HandOver&) = delete;
  HandOver& operator=(const HandOver&) = delete;

  void Start();
  void Stop();
  /// There may be something new to hand over.
  void Wake();

 private:
  void Run();
  /// Goes through all scans; true while one of them waits for a running reconstruction.
  bool PassOver();
  /// Does what can be done for a scan now.
  Status Advance(const std::string& id);
  Status SendFrames(const ScanRecord& record, const ScanRequest& request);
  Status SendFrame(const std::string& id, const std::string& set, const ScanFrame& frame);
  Result<std::string> EnsureSet(const ScanRecord& record, const ScanRequest& request);
  Status AskForJob(const ScanRecord& record, const ScanRequest& request);
  /// Notes when the job reaches its stages, as seconds from the last shutter.
  Status WatchJob(ScanRecord record, const ScanRequest& request);
  Status WatchReport(ScanRecord record, const std::string& url);
  void NoteError(const std::string& id, const Status& status);
  bool IsStopping();

  ScanStore& scans_;
  JobStore& jobs_;
  ObjectStore& objects_;
  const Client client_;
  const HandOverOptions options_;
  std::mutex mutex_;
  std::condition_variable wake_;
  bool stopping_ = false, woken_ = false;
  std::map<std::string, std::string> last_error_;  ///< by scan, so that each is written once
  std::thread thread_;
};

}  // namespace drupe
