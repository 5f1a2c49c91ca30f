#pragma once

#include <atomic>
#include <string>

#include "base/clock.h"
#include "http/metrics.h"
#include "http/request.h"
#include "http/request_head.h"
#include "http/response.h"
#include "http/router.h"
#include "http/server.h"

namespace drupe {

/// The reply to a client that met a full server: 503 `server_busy`.
Status ServerBusy(std::string_view why);

/// Decides whether a request is let in, and has its route's handler answer it. Knows nothing of sockets. Thread-safe.
class Dispatcher {
 public:
  /// `metrics` may be null. Both outlive the dispatcher.
  Dispatcher(const ServerOptions& options, Metrics* metrics) : options_(options), metrics_(metrics) {}

  Router& router() { return router_; }

  /// What is answered to a request with this head, or to the error that reading it gave. `request` comes with its id,
  /// its body and the client's address, and is filled. `reserved_only`: only reserved routes may be reached.
  Response Answer(Result<RequestHead> head, bool reserved_only, Request& request);

 private:
  Response Dispatch(RequestHead& head, bool reserved_only, Request& request);
  Status Admit(const RouteOptions& route, std::uint64_t content_length, bool reserved_only) const;
  /// Runs the route when the request's token allows it.
  Response RunWithPass(const Router::Route& route, Request& request);
  Response Run(const Router::Route& route, const Request& request);
  void HoldEventStream(Response& response);
  void Record(const Request& request, const Response& response, const Stopwatch& watch) const;

  const ServerOptions& options_;
  Metrics* const metrics_;
  Router router_;
  std::atomic<int> uploads_{0};
  std::atomic<int> event_streams_{0};
};

}  // namespace drupe
