#pragma once

#include <string_view>

#include "base/json.h"
#include "base/status.h"

namespace drupe {

/// The HTTP status code of an outcome: the only place where one becomes the other. The kind decides, except for the few
/// codes that only the protocol knows (`method_not_allowed` 405, `request_timeout` 408, ...). OK gives 200.
int HttpStatusOf(const Status& status);

/// The kind that a reply's status code means to a client of another service; 2xx gives kOk, codes without a kind of
/// their own give kInvalidArgument (4xx) or kInternal (the rest).
StatusKind KindOfHttpStatus(int http_status);

/// {"error": {"code", "message", "field"}}; `field` only when there is one.
Json ErrorBody(const Status& status);

}  // namespace drupe
