#include "base/parallel.h"

#include <algorithm>
#include <atomic>
#include <exception>
#include <mutex>
#include <string>
#include <thread>
#include <vector>

namespace drupe {

int RunContext::ThreadCount() const {
  if (threads > 0) return threads;
  return std::max(1, static_cast<int>(std::thread::hardware_concurrency()));
}

namespace {

/// The state that the workers of one ParallelFor share.
struct SharedWork {
  std::atomic<std::size_t> next{0};
  std::atomic<bool> stop{false};
  std::mutex mutex;
  std::string failure;  // guarded by mutex
};

void RunWorker(const RunContext& context, std::size_t count,
               const std::function<void(std::size_t, int)>& body, int worker, SharedWork& work) {
  try {
    while (!work.stop.load(std::memory_order_relaxed) && !context.IsCancelled()) {
      const std::size_t index = work.next.fetch_add(1, std::memory_order_relaxed);
      if (index >= count) return;
      body(index, worker);
    }
  } catch (const std::exception& error) {
    work.stop = true;
    const std::lock_guard lock(work.mutex);
    if (work.failure.empty()) work.failure = error.what();
  }
}

}  // namespace

Status ParallelForWorkers(const RunContext& context, std::size_t count,
                          const std::function<void(std::size_t, int)>& body) {
  const int workers = static_cast<int>(std::min<std::size_t>(count, context.ThreadCount()));
  SharedWork work;
  std::vector<std::thread> threads;
  for (int worker = 1; worker < workers; ++worker) {
    threads.emplace_back([&, worker] { RunWorker(context, count, body, worker, work); });
  }
  RunWorker(context, count, body, 0, work);
  for (std::thread& thread : threads) thread.join();
  if (!work.failure.empty()) return Internal("internal", work.failure);
  return context.CheckCancelled();
}

Status ParallelFor(const RunContext& context, std::size_t count, const std::function<void(std::size_t)>& body) {
  return ParallelForWorkers(context, count, [&body](std::size_t index, int) { body(index); });
}

}  // namespace drupe
