#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <string>
#include <string_view>

#include "base/status.h"
#include "http/request.h"

namespace drupe {

struct HeadLimits {
  std::size_t max_target_bytes = 2048;
  int max_headers = 64;
};

/// What the head of a request says, checked as strictly as RFC 9112 allows: a head that two programs could read in two
/// ways is refused, never repaired.
struct RequestHead {
  std::string method;
  std::string path;   ///< as sent
  std::string query;  ///< as sent, without the question mark
  HeaderMap headers;
  std::uint64_t content_length = 0;
  bool keep_alive = true;
  bool expects_continue = false;
};

/// Reads a request line and headers, `text` ending with the empty line. Errors: 400 `invalid_request` (syntax, control
/// characters, folded lines, no Host, repeated or bad Content-Length), 411 `length_required` (Transfer-Encoding), 414
/// `target_too_long`, 415 `unsupported_encoding` (Content-Encoding), 417 `expectation_failed`, 431 `headers_too_large`,
/// 505 `unsupported_version`.
Result<RequestHead> ParseRequestHead(std::string_view text, const HeadLimits& limits = {});

/// Reads a query string. Errors: 400 `invalid_parameter` (bad escapes, more than 32 parameters).
Result<std::map<std::string, std::string, std::less<>>> ParseQuery(std::string_view query);

}  // namespace drupe
