#pragma once

#include <atomic>
#include <chrono>
#include <cstdint>
#include <functional>
#include <limits>
#include <optional>
#include <span>
#include <string>
#include <string_view>

#include "base/status.h"
#include "http/request.h"
#include "http/server.h"

namespace drupe {

/// Milliseconds of the steady clock, for deadlines that threads share.
std::int64_t SteadyNowMs();
inline constexpr std::int64_t kNoDeadline = std::numeric_limits<std::int64_t>::max();

/// One client's socket, read and written under deadlines. A request's body is a window of exactly its declared length:
/// neither more of the stream than that can be read as body, nor any of the body as the next request. Owns the socket.
class Connection : public BodyReader {
 public:
  /// Bodies are not read beyond `body_deadline_ms` (SteadyNowMs), which may change meanwhile. Both references outlive
  /// the connection.
  Connection(int socket, const ServerOptions& options, const std::atomic<std::int64_t>& body_deadline_ms)
      : socket_(socket), options_(options), body_deadline_ms_(body_deadline_ms) {}
  ~Connection() override;
  Connection(const Connection&) = delete;
  Connection& operator=(const Connection&) = delete;

  /// Waits up to `idle` for a request's first byte, giving up early when `give_up` says so. False: nothing came.
  bool WaitForRequest(std::chrono::milliseconds idle, const std::function<bool()>& give_up);
  /// Reads up to the empty line after the headers. Errors: 431 `headers_too_large`, 408 `request_timeout`, 400
  /// `invalid_request` when the client leaves in between.
  Result<std::string> ReadHead();

  /// Opens the window of the next body. `expects_continue`: "100 Continue" is sent before the first byte is read.
  void StartBody(std::uint64_t length, bool expects_continue);
  std::uint64_t length() const override { return length_; }
  std::uint64_t remaining() const override { return remaining_; }
  Result<std::size_t> Read(std::span<char> buffer) override;

  /// Writes everything, or returns false when the client takes nothing for the stall timeout or has gone.
  bool Write(std::string_view bytes);
  /// True once the client has closed its side or the connection is broken.
  bool PeerHasGone() const;
  /// Ends the conversation so that the last reply arrives: the client may still be sending a body that nobody wants,
  /// and closing over unread bytes would make the system drop our reply. Reads on for up to two seconds.
  void LingeringClose();
  /// Throws away what has arrived, so that closing does not make the system drop our reply. Does not wait.
  void DiscardArrived();
  std::string RemoteAddress() const;

 private:
  /// The next bytes: those read ahead, else from the socket. 0: the client has closed. Waits up to `timeout`.
  Result<std::size_t> Receive(std::span<char> buffer, std::chrono::milliseconds timeout);
  std::chrono::milliseconds BodyPatience() const;

  const int socket_;
  const ServerOptions& options_;
  const std::atomic<std::int64_t>& body_deadline_ms_;
  std::string ahead_;  ///< read beyond the last head; at most max_head_bytes
  std::uint64_t length_ = 0;
  std::uint64_t remaining_ = 0;
  bool continue_due_ = false;
  std::chrono::steady_clock::time_point body_start_;
};

}  // namespace drupe
