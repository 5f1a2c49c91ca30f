#include "http/request_head.h"

#include <algorithm>
#include <cctype>
#include <charconv>

#include "http/router.h"
#include "http/text.h"

namespace drupe {

namespace {

constexpr int kMaxQueryParameters = 32;
constexpr std::size_t kMaxMethodBytes = 16;

Status Malformed(std::string_view why) {
  return InvalidArgument("invalid_request", "the request is malformed: " + std::string(why));
}

bool IsTokenChar(char c) {
  return std::isalnum(static_cast<unsigned char>(c)) != 0 ||
         std::string_view("!#$%&'*+-.^_`|~").find(c) != std::string_view::npos;
}

bool IsToken(std::string_view text) {
  return !text.empty() && std::all_of(text.begin(), text.end(), IsTokenChar);
}

bool IsVisible(char c) {
  return static_cast<unsigned char>(c) > 0x20 && static_cast<unsigned char>(c) < 0x7f;
}

bool IsFieldChar(char c) {
  return c == '\t' || (static_cast<unsigned char>(c) >= 0x20 && c != 0x7f);
}

/// Takes the text up to CR LF from the front of `text`.
std::string_view TakeLine(std::string_view& text) {
  const std::size_t end = text.find("\r\n");
  const std::string_view line = text.substr(0, end);
  text.remove_prefix(end == std::string_view::npos ? text.size() : end + 2);
  return line;
}

Status ParseTarget(std::string_view target, const HeadLimits& limits, RequestHead& head) {
  if (target.size() > limits.max_target_bytes) {
    return InvalidArgument("target_too_long",
                           "path and query are longer than " + std::to_string(limits.max_target_bytes) + " bytes");
  }
  if (!target.starts_with('/') || !std::all_of(target.begin(), target.end(), IsVisible)) {
    return Malformed("the target must be a path");
  }
  target = target.substr(0, target.find('#'));
  const std::size_t question = target.find('?');
  head.path = target.substr(0, question);
  if (question != std::string_view::npos) head.query = target.substr(question + 1);
  return Status::Ok();
}

Status ParseRequestLine(std::string_view line, const HeadLimits& limits, RequestHead& head) {
  const std::size_t first = line.find(' ');
  const std::size_t last = line.rfind(' ');
  if (first == std::string_view::npos || first == last) return Malformed("the request line has not three parts");
  head.method = line.substr(0, first);
  if (!IsToken(head.method) || head.method.size() > kMaxMethodBytes) return Malformed("the method");
  const std::string_view version = line.substr(last + 1);
  if (version != "HTTP/1.1" && version != "HTTP/1.0") {
    return InvalidArgument("unsupported_version", "only HTTP/1.1 and HTTP/1.0 are spoken here");
  }
  head.keep_alive = version == "HTTP/1.1";
  return ParseTarget(line.substr(first + 1, last - first - 1), limits, head);
}

Status ParseHeaderLine(std::string_view line, RequestHead& head) {
  const std::size_t colon = line.find(':');
  if (colon == std::string_view::npos || !IsToken(line.substr(0, colon))) return Malformed("a header's name");
  const std::string_view value = Trim(line.substr(colon + 1));
  if (!std::all_of(value.begin(), value.end(), IsFieldChar)) return Malformed("a header's value");
  head.headers.emplace(line.substr(0, colon), value);
  return Status::Ok();
}

Status CheckLength(RequestHead& head) {
  if (head.headers.count("Transfer-Encoding") > 0) {
    return Status(StatusKind::kLengthRequired, "length_required",
                  "bodies need a Content-Length; Transfer-Encoding is not accepted", "Transfer-Encoding");
  }
  if (head.headers.count("Content-Length") == 0) return Status::Ok();
  if (head.headers.count("Content-Length") > 1) return Malformed("more than one Content-Length");
  const std::string& text = head.headers.find("Content-Length")->second;
  const char* const end = text.data() + text.size();
  const auto [last, error] = std::from_chars(text.data(), end, head.content_length);
  if (text.empty() || error != std::errc() || last != end) return Malformed("Content-Length is not a number");
  return Status::Ok();
}

Status CheckEncoding(const RequestHead& head) {
  const auto found = head.headers.find("Content-Encoding");
  if (found == head.headers.end() || Lower(found->second) == "identity") return Status::Ok();
  return Status(StatusKind::kUnsupportedMedia, "unsupported_encoding",
                "compressed bodies are not accepted; send the body as it is", "Content-Encoding");
}

Status CheckExpectation(RequestHead& head) {
  const auto found = head.headers.find("Expect");
  if (found == head.headers.end()) return Status::Ok();
  if (Lower(found->second) != "100-continue") {
    return InvalidArgument("expectation_failed", "only Expect: 100-continue is understood", "Expect");
  }
  head.expects_continue = true;
  return Status::Ok();
}

Status CheckHeaders(RequestHead& head) {
  if (head.headers.count("Host") != 1 && (head.keep_alive || head.headers.count("Host") > 1)) {
    return Malformed("there must be one Host header");
  }
  DRUPE_RETURN_IF_ERROR(CheckLength(head));
  DRUPE_RETURN_IF_ERROR(CheckEncoding(head));
  DRUPE_RETURN_IF_ERROR(CheckExpectation(head));
  const auto connection = head.headers.find("Connection");
  if (connection != head.headers.end() && Lower(connection->second).find("close") != std::string::npos) {
    head.keep_alive = false;
  }
  return Status::Ok();
}

}  // namespace

Result<RequestHead> ParseRequestHead(std::string_view text, const HeadLimits& limits) {
  RequestHead head;
  DRUPE_RETURN_IF_ERROR(ParseRequestLine(TakeLine(text), limits, head));
  int count = 0;
  for (std::string_view line = TakeLine(text); !line.empty(); line = TakeLine(text)) {
    if (++count > limits.max_headers) {
      return InvalidArgument("headers_too_large",
                             "there are more than " + std::to_string(limits.max_headers) + " headers");
    }
    DRUPE_RETURN_IF_ERROR(ParseHeaderLine(line, head));
  }
  DRUPE_RETURN_IF_ERROR(CheckHeaders(head));
  return head;
}

Result<std::map<std::string, std::string, std::less<>>> ParseQuery(std::string_view query) {
  std::map<std::string, std::string, std::less<>> parameters;
  int count = 0;
  while (!query.empty()) {
    const std::size_t end = std::min(query.find('&'), query.size());
    const std::string_view pair = query.substr(0, end);
    query.remove_prefix(std::min(end + 1, query.size()));
    const std::size_t equals = std::min(pair.find('='), pair.size());
    const Result<std::string> name = PercentDecode(pair.substr(0, equals), true);
    const Result<std::string> value = PercentDecode(pair.substr(std::min(equals + 1, pair.size())), true);
    if (!name.ok() || !value.ok() || ++count > kMaxQueryParameters) {
      return InvalidArgument("invalid_parameter", "the query has a broken escape or too many parameters");
    }
    parameters[*name] = *value;
  }
  return parameters;
}

}  // namespace drupe
