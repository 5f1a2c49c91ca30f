#pragma once

#include <atomic>
#include <functional>
#include <string>
#include <thread>

#include "jobs/postgres/connection.h"

namespace drupe {

/// Hears what other processes announce (NOTIFY) on a connection and a thread of its own.
class Announcements {
 public:
  /// `on_announcement` is called for every announcement that comes from a server process other than `own_pid`, and once
  /// after each connection but the first, since something may have been missed while there was none.
  Announcements(PostgresTarget target, std::string channel, const std::atomic<int>& own_pid,
                std::function<void()> on_announcement);
  ~Announcements();

 private:
  void Loop();
  /// Waits until the server has sent something or this object is closed; false when the connection is lost.
  bool WaitForInput();
  bool Listen();
  void Deliver();

  const std::string channel_;
  const std::atomic<int>& own_pid_;
  const std::function<void()> on_announcement_;
  PostgresConnection connection_;
  int wake_fd_;
  bool listening_;
  std::atomic<bool> closing_{false};
  std::thread thread_;
};

}  // namespace drupe
