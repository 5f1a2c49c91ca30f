#include "http/outside_post.h"

#include <httplib.h>

namespace drupe {

namespace {

/// More of a reply is not read.
constexpr std::size_t kMaxReplyBytes = 64 << 10;

std::string SchemeAndHost(const OutsideUrl& url) {
  const bool v6 = url.host.find(':') != std::string::npos;
  const std::string host = v6 ? "[" + url.host + "]" : url.host;
  return (url.tls ? "https://" : "http://") + host + ":" + std::to_string(url.port);
}

}  // namespace

Status PostOutside(const OutsideUrl& url, const std::string& body,
                   const std::vector<std::pair<std::string, std::string>>& headers, const OutsidePostOptions& options) {
  DRUPE_ASSIGN_OR_RETURN(const std::string address, ResolveOutside(url, options.allowed_hosts));
  httplib::Client client(SchemeAndHost(url));
  // The address that was looked at: the name may mean another one by now.
  client.set_hostname_addr_map({{url.host, address}});
  client.set_connection_timeout(options.connect_timeout);
  client.set_read_timeout(options.read_timeout);
  client.set_write_timeout(options.read_timeout);
  client.set_follow_location(false);
  client.set_decompress(false);
  client.enable_server_certificate_verification(true);
  httplib::Request request;
  request.method = "POST";
  request.path = url.path;
  request.body = body;
  request.set_header("Content-Type", "application/json");
  for (const auto& [name, value] : headers) request.set_header(name.c_str(), value);
  std::size_t received = 0;
  request.content_receiver = [&](const char*, std::size_t size, std::uint64_t, std::uint64_t) {
    received += size;
    return received <= kMaxReplyBytes;
  };
  int http_status = 0;
  request.response_handler = [&](const httplib::Response& reply) {
    http_status = reply.status;
    return true;
  };
  const httplib::Result result = client.send(request);
  if (http_status == 0 && !result) {
    return {StatusKind::kUnavailable, "unreachable",
            url.host + " cannot be reached (" + httplib::to_string(result.error()) + ")"};
  }
  if (http_status == 0) http_status = result->status;
  if (http_status >= 200 && http_status < 300) return Status::Ok();
  return {StatusKind::kUnavailable, "webhook_not_taken", url.host + " answered " + std::to_string(http_status)};
}

}  // namespace drupe
