#pragma once

#include <atomic>

#include "http/connection.h"
#include "http/response.h"

namespace httplib {
struct Response;
}

namespace drupe {

/// Puts `response` into the library's response. A source is read while it is sent; events are produced until the client
/// has gone, the producer ends or `stopping` is true. `connection` and `stopping` outlive the sending.
void FillReply(Response response, Connection& connection, const std::atomic<bool>& stopping, httplib::Response& reply);

}  // namespace drupe
