#include "http/connection_threads.h"

#include <httplib.h>

#include <condition_variable>
#include <deque>
#include <functional>
#include <mutex>
#include <thread>
#include <vector>

namespace drupe {

namespace {

thread_local bool refusing = false;

class ConnectionThreads : public httplib::TaskQueue {
 public:
  explicit ConnectionThreads(int count);

  void enqueue(std::function<void()> serve) override;
  /// Returns when every connection has been served.
  void shutdown() override;

 private:
  void Work();

  std::mutex mutex_;
  std::condition_variable changed_;
  std::deque<std::function<void()>> waiting_;
  int busy_ = 0;  ///< connections being served or waiting for a thread to wake up
  bool stopping_ = false;
  std::vector<std::thread> threads_;
};

ConnectionThreads::ConnectionThreads(int count) {
  for (int i = 0; i < count; ++i) threads_.emplace_back([this] { Work(); });
}

void ConnectionThreads::enqueue(std::function<void()> serve) {
  {
    const std::lock_guard lock(mutex_);
    if (busy_ < static_cast<int>(threads_.size())) {
      ++busy_;
      waiting_.push_back(std::move(serve));
      changed_.notify_one();
      return;
    }
  }
  refusing = true;
  serve();
  refusing = false;
}

void ConnectionThreads::shutdown() {
  {
    const std::lock_guard lock(mutex_);
    stopping_ = true;
  }
  changed_.notify_all();
  for (std::thread& thread : threads_) thread.join();
}

void ConnectionThreads::Work() {
  while (true) {
    std::function<void()> serve;
    {
      std::unique_lock lock(mutex_);
      changed_.wait(lock, [&] { return stopping_ || !waiting_.empty(); });
      if (waiting_.empty()) return;
      serve = std::move(waiting_.front());
      waiting_.pop_front();
    }
    serve();
    const std::lock_guard lock(mutex_);
    --busy_;
  }
}

}  // namespace

httplib::TaskQueue* NewConnectionThreads(int count) {
  return new ConnectionThreads(count);
}

bool IsRefusingConnection() {
  return refusing;
}

}  // namespace drupe
