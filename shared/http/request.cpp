#include "http/request.h"

#include <algorithm>
#include <cassert>
#include <charconv>

#include "http/text.h"

namespace drupe {

namespace {

bool EqualFolded(std::string_view a, std::string_view b) {
  return std::equal(a.begin(), a.end(), b.begin(), b.end(), [](char x, char y) { return Lower(x) == Lower(y); });
}

}  // namespace

bool HeaderLess::operator()(std::string_view a, std::string_view b) const {
  return std::lexicographical_compare(a.begin(), a.end(), b.begin(), b.end(),
                                      [](char x, char y) { return Lower(x) < Lower(y); });
}

std::string_view Request::Header(std::string_view name) const {
  const auto found = headers.find(name);
  return found == headers.end() ? std::string_view() : std::string_view(found->second);
}

const std::string& Request::Capture(std::string_view name) const {
  const auto found = captures.find(name);
  assert(found != captures.end());
  return found->second;
}

std::optional<std::string> Request::Query(std::string_view name) const {
  const auto found = query.find(name);
  if (found == query.end()) return std::nullopt;
  return found->second;
}

Result<std::int64_t> Request::QueryInt(std::string_view name, std::int64_t fallback, std::int64_t low,
                                       std::int64_t high) const {
  const std::optional<std::string> text = Query(name);
  if (!text) return fallback;
  std::int64_t value = 0;
  const char* const end = text->data() + text->size();
  const auto [last, error] = std::from_chars(text->data(), end, value);
  if (error != std::errc() || last != end || value < low || value > high) {
    return InvalidArgument(
        "invalid_parameter",
        std::string(name) + " must be a whole number from " + std::to_string(low) + " to " + std::to_string(high),
        std::string(name));
  }
  return value;
}

bool Request::HasMediaType(std::string_view type) const {
  std::string_view value = Header("Content-Type");
  value = value.substr(0, value.find(';'));
  while (!value.empty() && (value.back() == ' ' || value.back() == '\t')) value.remove_suffix(1);
  return EqualFolded(value, type);
}

Result<std::string> ReadBody(const Request& request, std::size_t max_bytes) {
  if (request.body->length() > max_bytes) {
    return Status(
        StatusKind::kTooLarge, "body_too_large",
        "the body has " + std::to_string(request.body->length()) + " bytes; the limit is " + std::to_string(max_bytes));
  }
  std::string bytes(static_cast<std::size_t>(request.body->remaining()), '\0');
  std::size_t filled = 0;
  while (filled < bytes.size()) {
    DRUPE_ASSIGN_OR_RETURN(const std::size_t count,
                           request.body->Read(std::span(bytes.data() + filled, bytes.size() - filled)));
    if (count == 0) break;
    filled += count;
  }
  bytes.resize(filled);
  return bytes;
}

Result<Json> ReadJsonBody(const Request& request, const JsonLimits& limits) {
  if (!request.HasMediaType("application/json")) {
    return Status(StatusKind::kUnsupportedMedia, "unsupported_media_type",
                  "the body must be JSON, sent with Content-Type: application/json", "Content-Type");
  }
  DRUPE_ASSIGN_OR_RETURN(const std::string text, ReadBody(request, limits.max_bytes));
  return ParseJson(text, limits);
}

}  // namespace drupe
