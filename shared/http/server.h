#pragma once

#include <chrono>
#include <cstddef>
#include <memory>
#include <string>

#include "base/status.h"
#include "http/metrics.h"
#include "http/router.h"

namespace drupe {

/// How a server treats its clients.
struct ServerOptions {
  std::string host = "127.0.0.1";
  int port = 0;                                           ///< 0: any free port
  int max_connections = 64;                               ///< served at once, a thread each; more are refused with 503
  int reserved_connections = 8;                           ///< further ones, which only reach reserved routes (/healthz)
  int max_event_streams = 16;                             ///< server-sent event streams at once, 503 above
  int max_concurrent_uploads = 8;                         ///< requests to upload routes at once, 503 above
  std::uint64_t max_body_bytes = std::uint64_t{2} << 30;  ///< of any route
  std::size_t max_head_bytes = 16 << 10;                  ///< request line and headers: 431 above
  std::size_t max_target_bytes = 2048;                    ///< path and query: 414 above
  int max_headers = 64;                                   ///< 431 above
  std::chrono::milliseconds head_timeout{10'000};         ///< from a request's first byte to the end of its headers
  std::chrono::milliseconds keep_alive_timeout{5'000};    ///< between requests
  std::chrono::milliseconds stall_timeout{15'000};        ///< a body that brings no byte, a reply that takes none
  std::chrono::milliseconds stop_timeout{10'000};         ///< that bodies still arriving are given after Stop()
  std::size_t min_body_bytes_per_s = 1024;                ///< on average, after the first stall_timeout
  int max_requests_per_connection = 1000;
  std::shared_ptr<AccessControl> access;  ///< null: everybody may do everything

  /// Errors: 400 `invalid_option` with the option that is out of range.
  Status Check() const;
};

/// An HTTP/1.1 server over cpp-httplib, with a fence in front of it: the fence reads each request's head itself within
/// limits, decides on admission before the body is touched, and gives the library one clean request at a time. So
/// bodies need a Content-Length (411), content encodings are refused (415), sizes are checked before reading (413),
/// unread bodies close the connection, and no header, path or body reaches the library's own parsers unchecked.
class Server {
 public:
  Server(ServerOptions options, Metrics* metrics);
  ~Server();

  Router& router();

  /// Binds; afterwards port() is known. Errors: 409 `port_in_use` and other reasons with the address in the message.
  Status Bind();
  int port() const;
  /// Serves until Stop(); call after Bind(). Returns when every handler has returned. Errors: 500 `listen_failed`.
  Status Serve();
  /// Stops accepting, ends event streams and idle connections; requests being answered are finished. Any thread, once.
  void Stop();
  bool stopping() const;

 private:
  class Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace drupe
