#pragma once

#include <memory>
#include <utility>

#include "http/router.h"

namespace drupe {

/// Adds the methods of one object as routes, which keep it alive: `Status Method(const Request&, Response&)`, whose
/// error becomes the reply.
///
///   const auto add = MethodRoutes(router, std::make_shared<ScanRoutes>(context));
///   add("GET", "/scans", {.max_body_bytes = 0}, &ScanRoutes::List);
template <typename Routes>
auto MethodRoutes(Router& router, std::shared_ptr<Routes> routes) {
  return [&router, routes = std::move(routes)](const char* verb, const char* pattern, const RouteOptions& options,
                                               auto method) {
    router.Add(verb, pattern, options, [routes, method](const Request& request, Response& response) {
      if (const Status status = ((*routes).*method)(request, response); !status.ok()) response.SetError(status);
    });
  };
}

}  // namespace drupe
