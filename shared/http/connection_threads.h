#pragma once

#include <httplib.h>

#include <atomic>
#include <condition_variable>
#include <deque>
#include <functional>
#include <mutex>
#include <thread>
#include <vector>

namespace drupe {

/// The threads that serve connections, one each. The library's own pool queues without bound; here a connection that
/// finds no free thread is handed back to the accepting thread at once with Refusing() true, so that it is told 503.
class ConnectionThreads : public httplib::TaskQueue {
 public:
  explicit ConnectionThreads(int count);

  void enqueue(std::function<void()> serve) override;
  /// Returns when every connection has been served.
  void shutdown() override;

  /// True on the accepting thread while it turns a connection away.
  static bool Refusing();

 private:
  void Work();

  std::mutex mutex_;
  std::condition_variable changed_;
  std::deque<std::function<void()>> waiting_;
  int busy_ = 0;  ///< connections being served or waiting for a thread to wake up
  bool stopping_ = false;
  std::vector<std::thread> threads_;
};

}  // namespace drupe
