#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <string_view>

#include "base/status.h"
#include "http/request.h"
#include "http/response.h"

namespace drupe {

/// A part of a representation: `length` bytes from `offset`, within its size, length >= 1.
struct ByteRange {
  std::uint64_t offset = 0;
  std::uint64_t length = 0;
};

/// Reads a Range header against a representation of `size` bytes (RFC 9110 section 14): "bytes=a-b", "bytes=a-",
/// "bytes=-n". Nothing for units other than bytes and for what is not a valid range: the whole is sent. Errors: 416
/// `range_not_satisfiable` for a range outside, and for more than one range, which would multiply the work.
Result<std::optional<ByteRange>> ParseRange(std::string_view header, std::uint64_t size);

/// True when If-None-Match (a list of entity tags, or "*") holds `etag`, by weak comparison.
bool MatchesEtag(std::string_view if_none_match, std::string_view etag);

/// Answers with `source`: 304 when the client has it, 206 for a Range (heeding If-Range), 416, or 200. `tag` identifies
/// the bytes (their SHA-256) and becomes the strong ETag.
void SendContent(const Request& request, std::shared_ptr<ByteSource> source, std::string_view content_type,
                 std::string_view tag, Response& response);

}  // namespace drupe
