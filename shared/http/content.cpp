#include "http/content.h"

#include <algorithm>
#include <charconv>

#include "http/text.h"

namespace drupe {

namespace {

/// A decimal number that fills `text`; nothing for anything else, overflow included.
std::optional<std::uint64_t> ParseNumber(std::string_view text) {
  std::uint64_t value = 0;
  const char* const end = text.data() + text.size();
  const auto [last, error] = std::from_chars(text.data(), end, value);
  if (text.empty() || error != std::errc() || last != end) return std::nullopt;
  return value;
}

Status NotSatisfiable(std::string message) {
  return Status(StatusKind::kRangeNotSatisfiable, "range_not_satisfiable", std::move(message), "Range");
}

Status OutsideOf(std::uint64_t size) {
  return NotSatisfiable("the range lies outside the " + std::to_string(size) + " bytes there are");
}

Result<std::optional<ByteRange>> SuffixRange(std::uint64_t count, std::uint64_t size) {
  const std::uint64_t length = std::min(count, size);
  if (length == 0) return OutsideOf(size);
  return std::optional(ByteRange{size - length, length});
}

std::string_view WithoutWeakMark(std::string_view tag) {
  return tag.starts_with("W/") ? tag.substr(2) : tag;
}

/// The range to send, heeding If-Range: a client that has parts of other bytes gets the whole.
Result<std::optional<ByteRange>> RequestedRange(const Request& request, std::string_view etag, std::uint64_t size) {
  const std::string_view if_range = request.Header("If-Range");
  if (!if_range.empty() && Trim(if_range) != etag) return std::optional<ByteRange>();
  return ParseRange(request.Header("Range"), size);
}

}  // namespace

Result<std::optional<ByteRange>> ParseRange(std::string_view header, std::uint64_t size) {
  constexpr std::string_view kUnit = "bytes=";
  header = Trim(header);
  if (!header.starts_with(kUnit)) return std::optional<ByteRange>();
  const std::string_view set = Trim(header.substr(kUnit.size()));
  if (set.find(',') != std::string_view::npos) return NotSatisfiable("only one range may be asked for at a time");
  const std::size_t dash = set.find('-');
  if (dash == std::string_view::npos) return std::optional<ByteRange>();
  const std::string_view first_text = set.substr(0, dash);
  const std::string_view last_text = set.substr(dash + 1);
  const std::optional<std::uint64_t> first = ParseNumber(first_text);
  const std::optional<std::uint64_t> last = ParseNumber(last_text);
  if (first_text.empty() && last) return SuffixRange(*last, size);
  if (!first || (!last && !last_text.empty()) || (last && *last < *first)) return std::optional<ByteRange>();
  if (*first >= size) return OutsideOf(size);
  const std::uint64_t end = last ? std::min(*last, size - 1) : size - 1;
  return std::optional(ByteRange{*first, end - *first + 1});
}

bool MatchesEtag(std::string_view if_none_match, std::string_view etag) {
  while (!if_none_match.empty()) {
    const std::size_t comma = if_none_match.find(',');
    const std::string_view tag = Trim(if_none_match.substr(0, comma));
    if (tag == "*" || (!tag.empty() && WithoutWeakMark(tag) == WithoutWeakMark(etag))) return true;
    if (comma == std::string_view::npos) return false;
    if_none_match.remove_prefix(comma + 1);
  }
  return false;
}

void SendContent(const Request& request, std::shared_ptr<ByteSource> source, std::string_view content_type,
                 std::string_view tag, Response& response) {
  const std::string etag = std::string(1, '"').append(tag).append(1, '"');
  const std::uint64_t size = source->size();
  const bool has_it = MatchesEtag(request.Header("If-None-Match"), etag);
  const Result<std::optional<ByteRange>> range = RequestedRange(request, etag, size);
  if (!has_it && !range.ok()) {
    response.SetError(range.status());
    response.SetHeader("Content-Range", "bytes */" + std::to_string(size));
    return;
  }
  response.SetHeader("ETag", etag);
  response.SetHeader("Cache-Control", "private, no-cache");
  response.SetHeader("Accept-Ranges", "bytes");
  if (has_it) {
    response.status = 304;
    return;
  }
  const ByteRange part = range->value_or(ByteRange{0, size});
  if (range->has_value()) {
    response.status = 206;
    response.SetHeader("Content-Range", "bytes " + std::to_string(part.offset) + "-" +
                                            std::to_string(part.offset + part.length - 1) + "/" + std::to_string(size));
  }
  response.content_type = content_type;
  response.source = std::move(source);
  response.source_offset = part.offset;
  response.source_length = part.length;
}

}  // namespace drupe
