#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <string_view>

#include "base/json.h"
#include "base/status.h"

namespace drupe {

/// The body of a request, read once from the front, straight from the connection. What a handler leaves unread is never
/// taken for another request: the connection is closed instead.
class BodyReader {
 public:
  virtual ~BodyReader() = default;
  /// The declared length in bytes; 0 without a body.
  virtual std::uint64_t length() const = 0;
  /// Bytes not read yet.
  virtual std::uint64_t remaining() const = 0;
  /// Reads at least one byte, at most buffer.size(); 0 at the end of the body. Errors: 400 `body_incomplete` when the
  /// client went away, 408 `request_timeout` when it sends slower than the server's limit.
  virtual Result<std::size_t> Read(std::span<char> buffer) = 0;
};

/// Names of headers are compared without regard to case.
struct HeaderLess {
  using is_transparent = void;
  bool operator()(std::string_view a, std::string_view b) const;
};
using HeaderMap = std::multimap<std::string, std::string, HeaderLess>;

/// One request, after admission: method and route are known, captures are valid, the declared body is within the limit.
struct Request {
  std::string method;  ///< "GET" also for HEAD: the server leaves the body out
  std::string path;    ///< as sent, without the query
  std::string route;   ///< the pattern that matched, "/reconstructions/{id:rec}"
  std::string id;      ///< for logs and the reply's X-Request-Id; the client's own X-Request-Id if it is one (IsTrace)
  std::string caller;  ///< name of the token, where there are tokens
  std::string remote_address;
  HeaderMap headers;
  std::map<std::string, std::string, std::less<>> captures;
  std::map<std::string, std::string, std::less<>> query;  ///< decoded; of a repeated name the last
  BodyReader* body = nullptr;                             ///< never null inside a handler

  /// The first header of that name, or "".
  std::string_view Header(std::string_view name) const;
  /// A capture of the route; asking for one that the pattern does not have is a programming error.
  const std::string& Capture(std::string_view name) const;
  std::optional<std::string> Query(std::string_view name) const;
  /// A query parameter that is a whole number in [low, high]; `fallback` when absent. Errors: 400 `invalid_parameter`.
  Result<std::int64_t> QueryInt(std::string_view name, std::int64_t fallback, std::int64_t low,
                                std::int64_t high) const;
  /// True when the body's media type is `type` ("multipart/form-data"), whatever its parameters.
  bool HasMediaType(std::string_view type) const;
};

/// The whole body in memory. Errors: 413 `body_too_large`, and those of BodyReader::Read.
Result<std::string> ReadBody(const Request& request, std::size_t max_bytes);

/// The body as JSON. Errors: 415 `unsupported_media_type` for another Content-Type, and those of ReadBody, ParseJson.
Result<Json> ReadJsonBody(const Request& request, const JsonLimits& limits = {});

}  // namespace drupe
