#include "http/client.h"

#include <httplib.h>

#include <charconv>
#include <utility>

#include "base/trace.h"
#include "http/status_map.h"

namespace drupe {

namespace {

constexpr std::size_t kMaxErrorBytes = 64 << 10;

std::string& ProcessToken() {
  static std::string token;
  return token;
}

httplib::Headers CommonHeaders() {
  httplib::Headers headers;
  if (!ProcessToken().empty()) headers.emplace("Authorization", "Bearer " + ProcessToken());
  if (!CurrentTrace().empty()) headers.emplace("X-Request-Id", CurrentTrace());
  return headers;
}

httplib::Client Connect(const std::string& base_url, const ClientOptions& options) {
  httplib::Client client(base_url);
  client.set_connection_timeout(options.connect_timeout);
  client.set_read_timeout(options.read_timeout);
  client.set_write_timeout(options.read_timeout);
  client.set_follow_location(false);
  client.set_decompress(false);
  client.set_default_headers(CommonHeaders());
  return client;
}

Status Unreachable(const std::string& base_url, httplib::Error error) {
  return Status(StatusKind::kUnavailable, "unreachable",
                base_url + " cannot be reached (" + httplib::to_string(error) + ")");
}

Status TooLarge(std::uint64_t limit) {
  return Status(StatusKind::kTooLarge, "reply_too_large",
                "the reply has more than " + std::to_string(limit) + " bytes");
}

/// The error that a reply with a status other than 2xx carries.
Status ErrorOfReply(int http_status, const std::string& body) {
  const StatusKind kind = KindOfHttpStatus(http_status);
  const Status plain(kind, "http_" + std::to_string(http_status),
                     "the service answered " + std::to_string(http_status));
  const Result<Json> json = ParseJson(body);
  if (!json.ok() || !json->is_object() || !json->contains("error") || !json->at("error").is_object()) return plain;
  const Json& error = json->at("error");
  const auto text = [&](const char* name, const std::string& fallback) {
    return error.contains(name) && error.at(name).is_string() ? error.at(name).get<std::string>() : fallback;
  };
  return Status(kind, text("code", plain.code()), text("message", plain.message()), text("field", ""));
}

Result<Client::Reply> ReadReply(const std::string& base_url, const httplib::Result& result, std::size_t max_bytes) {
  if (!result) return Unreachable(base_url, result.error());
  if (result->status < 200 || result->status > 299) return ErrorOfReply(result->status, result->body);
  if (result->body.empty()) return Client::Reply{result->status, Json()};
  Result<Json> json = ParseJson(result->body, {max_bytes, 64});
  if (!json.ok()) return Internal("bad_reply", "the service's reply is not JSON: " + json.status().message());
  return Client::Reply{result->status, std::move(*json)};
}

}  // namespace

void Client::SetToken(std::string token) {
  ProcessToken() = std::move(token);
}

Result<Client> Client::Create(std::string_view base_url, const ClientOptions& options) {
  const Status wrong =
      InvalidArgument("invalid_url", "a service's URL is http://host:port, not \"" + std::string(base_url) + "\"");
  constexpr std::string_view kScheme = "http://";
  if (!base_url.starts_with(kScheme)) return wrong;
  while (base_url.ends_with('/')) base_url.remove_suffix(1);
  const std::string_view rest = base_url.substr(std::min(kScheme.size(), base_url.size()));
  const std::size_t colon = rest.rfind(':');
  const std::string_view host = rest.substr(0, colon);
  if (host.empty() || rest.find_first_of("/?#@ ") != std::string_view::npos) return wrong;
  if (colon != std::string_view::npos) {
    int port = 0;
    const auto [end, error] = std::from_chars(rest.data() + colon + 1, rest.data() + rest.size(), port);
    if (error != std::errc() || end != rest.data() + rest.size() || port < 1 || port > 65535) return wrong;
  }
  return Client(std::string(base_url), options);
}

Result<Client::Reply> Client::Get(const std::string& path) const {
  std::string body;
  const Status status = Download(path, options_.max_json_bytes, [&](std::string_view piece) {
    body.append(piece);
    return true;
  });
  DRUPE_RETURN_IF_ERROR(status);
  Result<Json> json = ParseJson(body, {options_.max_json_bytes, 64});
  if (!json.ok()) return Internal("bad_reply", "the service's reply is not JSON: " + json.status().message());
  return Reply{200, std::move(*json)};
}

Result<Client::Reply> Client::Post(const std::string& path, const Json& body,
                                   const std::string& idempotency_key) const {
  httplib::Client client = Connect(base_url_, options_);
  httplib::Headers headers;
  if (!idempotency_key.empty()) headers.emplace("Idempotency-Key", idempotency_key);
  return ReadReply(base_url_, client.Post(path, headers, DumpJson(body), "application/json"), options_.max_json_bytes);
}

Result<Client::Reply> Client::Put(const std::string& path, std::string_view bytes, const std::string& content_type,
                                  const std::string& content_range) const {
  httplib::Client client = Connect(base_url_, options_);
  httplib::Headers headers;
  if (!content_range.empty()) headers.emplace("Content-Range", content_range);
  const httplib::Result result = client.Put(path, headers, bytes.data(), bytes.size(), content_type);
  return ReadReply(base_url_, result, options_.max_json_bytes);
}

Result<Client::Reply> Client::Delete(const std::string& path) const {
  httplib::Client client = Connect(base_url_, options_);
  return ReadReply(base_url_, client.Delete(path), options_.max_json_bytes);
}

Result<std::uint64_t> Client::Length(const std::string& path) const {
  httplib::Client client = Connect(base_url_, options_);
  const httplib::Result result = client.Head(path);
  if (!result) return Unreachable(base_url_, result.error());
  if (result->status < 200 || result->status > 299) return ErrorOfReply(result->status, "");
  return result->get_header_value<std::uint64_t>("Content-Length");
}

Status Client::Download(const std::string& path, std::uint64_t max_bytes,
                        const std::function<bool(std::string_view)>& sink, std::uint64_t offset) const {
  httplib::Client client = Connect(base_url_, options_);
  int http_status = 0;
  bool too_large = false;
  bool stopped = false;
  std::uint64_t received = 0;
  std::string error_body;
  httplib::Headers headers;
  if (offset > 0) headers.emplace("Range", "bytes=" + std::to_string(offset) + "-");
  const httplib::Result result = client.Get(
      path, headers,
      [&](const httplib::Response& reply) {
        http_status = reply.status;
        return true;
      },
      [&](const char* data, std::size_t size) {
        if (http_status < 200 || http_status > 299) {
          error_body.append(data, std::min(size, kMaxErrorBytes - std::min(kMaxErrorBytes, error_body.size())));
          return error_body.size() < kMaxErrorBytes;
        }
        if (offset > 0 && http_status == 200) return false;
        received += size;
        too_large = received > max_bytes;
        stopped = !too_large && !sink(std::string_view(data, size));
        return !too_large && !stopped;
      });
  if (offset > 0 && http_status == 200) return Internal("bad_reply", "a range was asked for, and the whole came");
  if (too_large) return TooLarge(max_bytes);
  if (stopped) return Cancelled();
  if (http_status != 0 && (http_status < 200 || http_status > 299)) return ErrorOfReply(http_status, error_body);
  return result ? Status::Ok() : Unreachable(base_url_, result.error());
}

}  // namespace drupe
