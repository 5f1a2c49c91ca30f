#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <string_view>
#include <vector>

#include "base/status.h"
#include "http/access.h"
#include "http/request.h"
#include "http/response.h"

namespace drupe {

using Handler = std::function<void(const Request&, Response&)>;

/// How a route is admitted.
struct RouteOptions {
  std::uint64_t max_body_bytes = 1 << 20;  ///< a larger Content-Length is refused with 413, unread
  bool upload = false;                     ///< counts against Limits::max_concurrent_uploads: 503 above it
  Scope scope = Scope::kByMethod;          ///< of the token that is asked for where there are tokens
  bool reserved = false;  ///< answered even when every ordinary connection is taken: /healthz and its like
};

/// Finds the route of a request. Patterns are written "/image-sets/{id:set}/images/{name}"; a capture is one whole path
/// segment, or its front part before a literal ending ("/reports/{id:rec}.csv"). `{x:prefix}` takes only ids of that
/// prefix (IsId), `{x}` only names (CheckImageName): nothing else, decoded or not, ever reaches a handler.
class Router {
 public:
  struct Route {
    std::string method;
    std::string pattern;
    RouteOptions options;
    Handler handler;
    std::vector<std::string> segments;  ///< of the pattern
  };

  /// Routes are tried in the order in which they were added.
  void Add(std::string method, std::string pattern, RouteOptions options, Handler handler);

  /// The route for a method and a path as sent; fills request.captures and request.route. HEAD finds GET's routes.
  /// Errors: 404 `unknown_route`, 405 `method_not_allowed` (then `allowed` lists the methods), 400 `invalid_path`
  /// (a bad escape, a control character).
  Result<const Route*> Find(std::string_view method, std::string_view path, Request& request,
                            std::string& allowed) const;

 private:
  std::vector<Route> routes_;
};

/// Decodes %XX, and + as a space when `plus_is_space`. Errors: 400 `invalid_path`.
Result<std::string> PercentDecode(std::string_view text, bool plus_is_space);

}  // namespace drupe
