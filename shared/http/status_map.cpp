#include "http/status_map.h"

#include <algorithm>
#include <iterator>

namespace drupe {

namespace {

struct ProtocolCode {
  std::string_view code;
  int http_status;
};

/// Outcomes of the protocol itself, which no kind of the rest of the system stands for.
constexpr ProtocolCode kProtocolCodes[] = {
    {"method_not_allowed", 405}, {"request_timeout", 408},   {"target_too_long", 414},
    {"expectation_failed", 417}, {"headers_too_large", 431}, {"unsupported_version", 505},
};

int HttpStatusOfKind(StatusKind kind) {
  switch (kind) {
    case StatusKind::kOk:
      return 200;
    case StatusKind::kInvalidArgument:
      return 400;
    case StatusKind::kUnauthorized:
      return 401;
    case StatusKind::kForbidden:
      return 403;
    case StatusKind::kNotFound:
      return 404;
    case StatusKind::kConflict:
      return 409;
    case StatusKind::kLengthRequired:
      return 411;
    case StatusKind::kPreconditionFailed:
      return 412;
    case StatusKind::kTooLarge:
      return 413;
    case StatusKind::kUnsupportedMedia:
      return 415;
    case StatusKind::kRangeNotSatisfiable:
      return 416;
    case StatusKind::kUnprocessable:
      return 422;
    case StatusKind::kTooManyRequests:
      return 429;
    case StatusKind::kCancelled:
      return 499;
    case StatusKind::kInternal:
      return 500;
    case StatusKind::kDataLoss:
      return 500;
    case StatusKind::kUnavailable:
      return 503;
    case StatusKind::kInsufficientStorage:
      return 507;
  }
  return 500;
}

}  // namespace

int HttpStatusOf(const Status& status) {
  const auto* const found = std::find_if(std::begin(kProtocolCodes), std::end(kProtocolCodes),
                                         [&](const ProtocolCode& entry) { return entry.code == status.code(); });
  return found != std::end(kProtocolCodes) ? found->http_status : HttpStatusOfKind(status.kind());
}

StatusKind KindOfHttpStatus(int http_status) {
  if (http_status >= 200 && http_status < 300) return StatusKind::kOk;
  switch (http_status) {
    case 401:
      return StatusKind::kUnauthorized;
    case 403:
      return StatusKind::kForbidden;
    case 404:
      return StatusKind::kNotFound;
    case 409:
      return StatusKind::kConflict;
    case 411:
      return StatusKind::kLengthRequired;
    case 412:
      return StatusKind::kPreconditionFailed;
    case 413:
      return StatusKind::kTooLarge;
    case 415:
      return StatusKind::kUnsupportedMedia;
    case 416:
      return StatusKind::kRangeNotSatisfiable;
    case 422:
      return StatusKind::kUnprocessable;
    case 429:
      return StatusKind::kTooManyRequests;
    case 502:
    case 503:
    case 504:
      return StatusKind::kUnavailable;
    case 507:
      return StatusKind::kInsufficientStorage;
    default:
      break;
  }
  return http_status >= 400 && http_status < 500 ? StatusKind::kInvalidArgument : StatusKind::kInternal;
}

Json ErrorBody(const Status& status) {
  Json error = {{"code", status.code()}, {"message", status.message()}};
  if (!status.field().empty()) error["field"] = status.field();
  return Json{{"error", error}};
}

}  // namespace drupe
