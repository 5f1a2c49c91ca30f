#pragma once

#include <chrono>
#include <cstdint>
#include <functional>
#include <string>
#include <string_view>

#include "base/json.h"
#include "base/status.h"

namespace drupe {

struct ClientOptions {
  std::chrono::milliseconds connect_timeout{3'000};
  std::chrono::milliseconds read_timeout{30'000};  ///< without a byte
  std::size_t max_json_bytes = std::size_t{64} << 20;
};

/// Calls another Drupe service. The URL is "http://host:port"; redirects are not followed. Every call opens a
/// connection of its own, so that a client may be shared between threads. Errors of every call: 503 `unreachable` (no
/// connection, timeout, cut reply); the other service's own error, with its code and message, and the kind that its
/// HTTP status means; 500 `bad_reply` for a reply that is not what was asked for.
class Client {
 public:
  /// Errors: 400 `invalid_url`.
  static Result<Client> Create(std::string_view base_url, const ClientOptions& options = {});

  /// The token with which this process speaks to other services (Authorization: Bearer); empty for none. Set once, at
  /// the start.
  static void SetToken(std::string token);

  /// A reply's JSON and its HTTP status (2xx).
  struct Reply {
    int http_status = 0;
    Json json;
  };

  Result<Reply> Get(const std::string& path) const;
  /// `idempotency_key` is sent as Idempotency-Key unless empty.
  Result<Reply> Post(const std::string& path, const Json& body, const std::string& idempotency_key = "") const;
  /// Sends bytes as they are, such as an image. `content_range` is sent as Content-Range unless empty.
  Result<Reply> Put(const std::string& path, std::string_view bytes, const std::string& content_type,
                    const std::string& content_range = "") const;
  Result<Reply> Delete(const std::string& path) const;
  /// Length in bytes of what Download would give.
  Result<std::uint64_t> Length(const std::string& path) const;

  /// Streams a reply's body, from byte `offset` on, to `sink`, which returns false to stop: the `cancelled` Status.
  /// Errors as above, and 413 `reply_too_large`, 416.
  Status Download(const std::string& path, std::uint64_t max_bytes, const std::function<bool(std::string_view)>& sink,
                  std::uint64_t offset = 0) const;

  const std::string& base_url() const { return base_url_; }

 private:
  Client(std::string base_url, const ClientOptions& options) : base_url_(std::move(base_url)), options_(options) {}

  std::string base_url_;
  ClientOptions options_;
};

}  // namespace drupe
