#include "http/router.h"

#include <cassert>
#include <optional>

#include "base/ids.h"

namespace drupe {

namespace {

constexpr std::size_t kMaxSegments = 16;

std::vector<std::string> SplitPattern(std::string_view pattern) {
  std::vector<std::string> segments;
  std::size_t start = 1;
  while (start <= pattern.size()) {
    const std::size_t slash = std::min(pattern.find('/', start), pattern.size());
    segments.emplace_back(pattern.substr(start, slash - start));
    start = slash + 1;
  }
  return segments;
}

int HexDigit(char c) {
  if (c >= '0' && c <= '9') return c - '0';
  if (c >= 'a' && c <= 'f') return c - 'a' + 10;
  if (c >= 'A' && c <= 'F') return c - 'A' + 10;
  return -1;
}

bool IsControl(char c) {
  return static_cast<unsigned char>(c) < 0x20 || c == 0x7f;
}

Status BadPath(std::string_view why) {
  return InvalidArgument("invalid_path", "the path " + std::string(why));
}

/// The segments of a path as sent, each decoded on its own, so that an encoded slash can never make a new segment.
Result<std::vector<std::string>> SplitPath(std::string_view path) {
  if (path.empty() || path.front() != '/') return BadPath("must start with a slash");
  std::vector<std::string> segments = SplitPattern(path);
  if (segments.size() > kMaxSegments) return BadPath("has too many parts");
  for (std::string& segment : segments) {
    DRUPE_ASSIGN_OR_RETURN(segment, PercentDecode(segment, false));
  }
  return segments;
}

/// A capture segment of a pattern, "{name:prefix}ending".
struct CaptureSpec {
  std::string_view name, prefix, ending;
};

std::optional<CaptureSpec> ParseCapture(std::string_view segment) {
  if (!segment.starts_with('{')) return std::nullopt;
  const std::size_t close = segment.find('}');
  assert(close != std::string_view::npos);
  const std::string_view inside = segment.substr(1, close - 1);
  const std::size_t colon = inside.find(':');
  CaptureSpec spec{inside.substr(0, colon), {}, segment.substr(close + 1)};
  if (colon != std::string_view::npos) spec.prefix = inside.substr(colon + 1);
  return spec;
}

bool MatchSegment(std::string_view pattern, std::string_view actual, Request& request) {
  const std::optional<CaptureSpec> capture = ParseCapture(pattern);
  if (!capture) return pattern == actual;
  if (!actual.ends_with(capture->ending)) return false;
  const std::string_view value = actual.substr(0, actual.size() - capture->ending.size());
  const bool valid = capture->prefix.empty() ? CheckImageName(value).ok() : IsId(value, capture->prefix);
  if (valid) request.captures[std::string(capture->name)] = value;
  return valid;
}

bool MatchRoute(const Router::Route& route, const std::vector<std::string>& path, Request& request) {
  request.captures.clear();
  if (route.segments.size() != path.size()) return false;
  for (std::size_t i = 0; i < path.size(); ++i) {
    if (!MatchSegment(route.segments[i], path[i], request)) return false;
  }
  request.route = route.pattern;
  return true;
}

}  // namespace

Result<std::string> PercentDecode(std::string_view text, bool plus_is_space) {
  std::string decoded;
  decoded.reserve(text.size());
  for (std::size_t i = 0; i < text.size(); ++i) {
    char c = text[i];
    if (c == '+' && plus_is_space) c = ' ';
    if (c == '%') {
      if (i + 2 >= text.size()) return BadPath("has a broken % escape");
      const int high = HexDigit(text[i + 1]), low = HexDigit(text[i + 2]);
      if (high < 0 || low < 0) return BadPath("has a broken % escape");
      c = static_cast<char>(high * 16 + low);
      i += 2;
    }
    if (IsControl(c)) return BadPath("has a control character");
    decoded.push_back(c);
  }
  return decoded;
}

void Router::Add(std::string method, std::string pattern, RouteOptions options, Handler handler) {
  assert(pattern.starts_with('/'));
  std::vector<std::string> segments = SplitPattern(pattern);
  routes_.push_back({std::move(method), std::move(pattern), options, std::move(handler), std::move(segments)});
}

Result<const Router::Route*> Router::Find(std::string_view method, std::string_view path, Request& request,
                                          std::string& allowed) const {
  DRUPE_ASSIGN_OR_RETURN(const std::vector<std::string> segments, SplitPath(path));
  const std::string_view wanted = method == "HEAD" ? "GET" : method;
  allowed.clear();
  for (const Route& route : routes_) {
    if (!MatchRoute(route, segments, request)) continue;
    if (route.method == wanted) return &route;
    if (allowed.find(route.method) == std::string::npos) allowed += (allowed.empty() ? "" : ", ") + route.method;
  }
  request.captures.clear();
  if (allowed.empty()) return NotFound("unknown_route", "there is nothing at this path");
  return Status(StatusKind::kInvalidArgument, "method_not_allowed", "this path takes only " + allowed);
}

}  // namespace drupe
