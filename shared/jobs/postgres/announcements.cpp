#include "jobs/postgres/announcements.h"

#include <poll.h>
#include <sys/eventfd.h>
#include <unistd.h>

#include <utility>

#include "base/log.h"

namespace drupe {

namespace {

constexpr int kRetryMs = 1'000;     ///< between attempts to connect
constexpr int kSilenceMs = 30'000;  ///< after which the connection is tried with a question

}  // namespace

Announcements::Announcements(PostgresTarget target, std::string channel, const std::atomic<int>& own_pid,
                             std::function<void()> on_announcement)
    : channel_(std::move(channel)),
      own_pid_(own_pid),
      on_announcement_(std::move(on_announcement)),
      connection_(std::move(target)),
      wake_fd_(::eventfd(0, EFD_CLOEXEC)),
      listening_(Listen()),
      thread_([this] { Loop(); }) {}

Announcements::~Announcements() {
  closing_ = true;
  (void)::eventfd_write(wake_fd_, 1);
  thread_.join();
  ::close(wake_fd_);
}

void Announcements::Loop() {
  while (!closing_) {
    while (listening_ && !closing_ && WaitForInput()) Deliver();
    connection_.Close();
    pollfd wake{wake_fd_, POLLIN, 0};
    ::poll(&wake, 1, kRetryMs);
    listening_ = !closing_ && Listen();
    if (listening_) on_announcement_();
  }
}

bool Announcements::Listen() {
  Status listening = connection_.EnsureConnected();
  if (listening.ok()) listening = connection_.Run("LISTEN " + channel_).status();
  if (!listening.ok()) Log(LogLevel::kWarning, "cannot listen for announcements", {{"error", listening.ToString()}});
  return listening.ok();
}

bool Announcements::WaitForInput() {
  pollfd ready[] = {{PQsocket(connection_.handle()), POLLIN, 0}, {wake_fd_, POLLIN, 0}};
  const int count = ::poll(ready, 2, kSilenceMs);
  if (count == 0) return connection_.Run("SELECT 1").ok();
  return PQconsumeInput(connection_.handle()) == 1;
}

void Announcements::Deliver() {
  bool from_others = false;
  while (PGnotify* const notice = PQnotifies(connection_.handle())) {
    from_others |= notice->be_pid != own_pid_;
    PQfreemem(notice);
  }
  if (from_others) on_announcement_();
}

}  // namespace drupe
