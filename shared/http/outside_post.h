#pragma once

#include <chrono>
#include <set>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "base/status.h"

namespace drupe {

/// A URL that a user has given for this process to call.
struct OutsideUrl {
  bool tls = false;
  std::string host;  ///< without the brackets of an IPv6 address
  int port = 0;
  std::string path;  ///< with the query; at least "/"
};

/// Reads "http[s]://host[:port][/path]", without user and fragment, of at most 2048 characters. Errors: 400
/// `invalid_webhook`.
Result<OutsideUrl> ParseOutsideUrl(std::string_view url);

/// Whether anybody on the Internet could have this address (IANA's special-purpose registries, RFC 6890): neither
/// loopback nor link-local, private, shared, multicast, documentation, nor an IPv6 form of such an IPv4 address.
/// False for what is no numeric address.
bool IsPublicAddress(const std::string& address);

/// The numeric address that may be called for `url`. Every address of the name must be public unless `allowed_hosts`
/// has the host, so that nobody reaches into the network of this machine through it. Errors: 403 `webhook_refused`, 503
/// `unreachable` when the name is not known.
Result<std::string> ResolveOutside(const OutsideUrl& url, const std::set<std::string>& allowed_hosts);

struct OutsidePostOptions {
  std::set<std::string> allowed_hosts;
  std::chrono::milliseconds connect_timeout{5'000};
  std::chrono::milliseconds read_timeout{10'000};
};

/// POSTs JSON to `url`, at the address that ResolveOutside gave and no other, and follows no redirect. OK for 2xx.
/// Errors: those of both functions above, 503 `unreachable`, `webhook_not_taken` with the status of the reply.
Status PostOutside(const OutsideUrl& url, const std::string& body,
                   const std::vector<std::pair<std::string, std::string>>& headers, const OutsidePostOptions& options);

}  // namespace drupe
