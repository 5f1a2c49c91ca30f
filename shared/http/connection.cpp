#include "http/connection.h"

#include <arpa/inet.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstring>

namespace drupe {

namespace {

using std::chrono::milliseconds;
using SteadyClock = std::chrono::steady_clock;

constexpr milliseconds kPollSlice{100};
constexpr milliseconds kLinger{2'000};

milliseconds Until(SteadyClock::time_point deadline) {
  return std::max(milliseconds(0), std::chrono::duration_cast<milliseconds>(deadline - SteadyClock::now()));
}

/// Waits until the socket is ready for `events`; false when the time is over.
bool WaitFor(int socket, short events, milliseconds timeout) {
  const SteadyClock::time_point deadline = SteadyClock::now() + timeout;
  while (true) {
    pollfd entry{socket, events, 0};
    const int ready = ::poll(&entry, 1, static_cast<int>(Until(deadline).count()));
    if (ready > 0) return true;
    if (ready == 0 || errno != EINTR) return false;
  }
}

Status TimedOut(std::string_view what) {
  return InvalidArgument("request_timeout", std::string(what) + " did not arrive in time");
}

Status ClientLeft() {
  return InvalidArgument("body_incomplete", "the connection ended before the whole body had come");
}

}  // namespace

std::int64_t SteadyNowMs() {
  return std::chrono::duration_cast<milliseconds>(SteadyClock::now().time_since_epoch()).count();
}

Connection::~Connection() {
  ::close(socket_);
}

bool Connection::WaitForRequest(milliseconds idle, const std::function<bool()>& give_up) {
  const SteadyClock::time_point deadline = SteadyClock::now() + idle;
  while (ahead_.empty()) {
    if (WaitFor(socket_, POLLIN, std::min(kPollSlice, Until(deadline)))) return !PeerHasGone();
    if (give_up() || Until(deadline) == milliseconds(0)) return false;
  }
  return true;
}

Result<std::string> Connection::ReadHead() {
  const SteadyClock::time_point deadline = SteadyClock::now() + options_.head_timeout;
  std::string text;
  std::array<char, 4096> buffer;
  while (true) {
    const std::size_t searched = text.size() < 3 ? 0 : text.size() - 3;
    DRUPE_ASSIGN_OR_RETURN(const std::size_t count, Receive(buffer, Until(deadline)));
    if (count == 0) return InvalidArgument("invalid_request", "the connection ended within the headers");
    text.append(buffer.data(), count);
    const std::size_t end = text.find("\r\n\r\n", searched);
    if (std::min(end, text.size()) > options_.max_head_bytes) {
      return InvalidArgument("headers_too_large", "request line and headers are longer than " +
                                                      std::to_string(options_.max_head_bytes) + " bytes");
    }
    if (end == std::string::npos) continue;
    ahead_.insert(0, text, end + 4);
    text.resize(end + 4);
    return text;
  }
}

void Connection::StartBody(std::uint64_t length, bool expects_continue) {
  length_ = remaining_ = length;
  continue_due_ = expects_continue && length > 0;
  body_start_ = SteadyClock::now();
}

milliseconds Connection::BodyPatience() const {
  const std::uint64_t earned_ms = (length_ - remaining_) * 1000 / options_.min_body_bytes_per_s;
  const SteadyClock::time_point average = body_start_ + options_.stall_timeout + milliseconds(earned_ms);
  const milliseconds shared(std::max<std::int64_t>(0, body_deadline_ms_ - SteadyNowMs()));
  return std::min({options_.stall_timeout, Until(average), shared});
}

Result<std::size_t> Connection::Read(std::span<char> buffer) {
  if (remaining_ == 0 || buffer.empty()) return std::size_t{0};
  if (continue_due_) {
    continue_due_ = false;
    if (!Write("HTTP/1.1 100 Continue\r\n\r\n")) return ClientLeft();
  }
  const std::size_t wanted = static_cast<std::size_t>(std::min<std::uint64_t>(buffer.size(), remaining_));
  const Result<std::size_t> count = Receive(buffer.first(wanted), BodyPatience());
  if (!count.ok()) return count.status().code() == "request_timeout" ? TimedOut("the body") : count.status();
  if (*count == 0) return ClientLeft();
  remaining_ -= *count;
  return *count;
}

Result<std::size_t> Connection::Receive(std::span<char> buffer, milliseconds timeout) {
  if (!ahead_.empty()) {
    const std::size_t count = std::min(buffer.size(), ahead_.size());
    std::memcpy(buffer.data(), ahead_.data(), count);
    ahead_.erase(0, count);
    return count;
  }
  const SteadyClock::time_point deadline = SteadyClock::now() + timeout;
  while (true) {
    if (!WaitFor(socket_, POLLIN, Until(deadline))) return TimedOut("the request");
    const ssize_t count = ::recv(socket_, buffer.data(), buffer.size(), MSG_DONTWAIT);
    if (count >= 0) return static_cast<std::size_t>(count);
    if (errno != EAGAIN && errno != EINTR) return ClientLeft();
  }
}

bool Connection::Write(std::string_view bytes) {
  while (!bytes.empty()) {
    const ssize_t count = ::send(socket_, bytes.data(), bytes.size(), MSG_DONTWAIT | MSG_NOSIGNAL);
    if (count >= 0) {
      bytes.remove_prefix(static_cast<std::size_t>(count));
    } else if (errno == EAGAIN) {
      if (!WaitFor(socket_, POLLOUT, options_.stall_timeout)) return false;
    } else if (errno != EINTR) {
      return false;
    }
  }
  return true;
}

bool Connection::PeerHasGone() const {
  char byte = 0;
  const ssize_t count = ::recv(socket_, &byte, 1, MSG_PEEK | MSG_DONTWAIT);
  return count == 0 || (count < 0 && errno != EAGAIN && errno != EINTR);
}

void Connection::LingeringClose() {
  ::shutdown(socket_, SHUT_WR);
  const SteadyClock::time_point deadline = SteadyClock::now() + kLinger;
  std::array<char, 16384> unwanted;
  while (WaitFor(socket_, POLLIN, Until(deadline)) && Until(deadline) > milliseconds(0)) {
    const ssize_t count = ::recv(socket_, unwanted.data(), unwanted.size(), MSG_DONTWAIT);
    if (count == 0 || (count < 0 && errno != EAGAIN && errno != EINTR)) return;
  }
}

void Connection::DiscardArrived() {
  constexpr int kMaxPieces = 16;
  ::shutdown(socket_, SHUT_WR);
  std::array<char, 4096> unwanted;
  for (int i = 0; i<kMaxPieces&& ::recv(socket_, unwanted.data(), unwanted.size(), MSG_DONTWAIT)> 0; ++i) {
  }
}

std::string Connection::RemoteAddress() const {
  sockaddr_storage address{};
  socklen_t size = sizeof(address);
  if (::getpeername(socket_, reinterpret_cast<sockaddr*>(&address), &size) != 0) return "";
  std::array<char, INET6_ADDRSTRLEN> text{};
  const void* const ip = address.ss_family == AF_INET6
                             ? static_cast<const void*>(&reinterpret_cast<const sockaddr_in6*>(&address)->sin6_addr)
                             : static_cast<const void*>(&reinterpret_cast<const sockaddr_in*>(&address)->sin_addr);
  return ::inet_ntop(address.ss_family, ip, text.data(), text.size()) != nullptr ? text.data() : "";
}

}  // namespace drupe
