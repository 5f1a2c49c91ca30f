#include <arpa/inet.h>
#include <netdb.h>
#include <netinet/in.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <charconv>
#include <cstring>
#include <memory>

#include "http/outside_post.h"

namespace drupe {

namespace {

constexpr std::size_t kMaxUrlBytes = 2048;
constexpr int kHttpPort = 80;
constexpr int kHttpsPort = 443;

Status BadUrl(const std::string& why) {
  return InvalidArgument("invalid_webhook", "a webhook is http[s]://host[:port]/path: " + why, "webhook");
}

/// Addresses whose first `bits` are those of `network`.
struct Network {
  std::uint32_t network;
  int bits;
};

constexpr Network kSpecialNetworks[] = {
    {0x00000000, 8},  {0x0a000000, 8},  {0x64400000, 10}, {0x7f000000, 8},  {0xa9fe0000, 16},
    {0xac100000, 12}, {0xc0000000, 24}, {0xc0000200, 24}, {0xc0586300, 24}, {0xc0a80000, 16},
    {0xc6120000, 15}, {0xc6336400, 24}, {0xcb007100, 24}, {0xe0000000, 4},  {0xf0000000, 4},
};

bool IsPublicV4(std::uint32_t address) {
  return std::none_of(std::begin(kSpecialNetworks), std::end(kSpecialNetworks),
                      [&](const Network& special) { return (address ^ special.network) >> (32 - special.bits) == 0; });
}

std::uint32_t BigEndian(const unsigned char* bytes) {
  return std::uint32_t{bytes[0]} << 24 | std::uint32_t{bytes[1]} << 16 | std::uint32_t{bytes[2]} << 8 | bytes[3];
}

/// Global unicast, 2000::/3, without the parts that are special or carry an IPv4 address: Teredo and protocol
/// assignments (2001::/23), documentation (2001:db8::/32, 3fff::/20), 6to4 (2002::/16).
bool IsPublicV6(const unsigned char* bytes) {
  const std::uint32_t head = BigEndian(bytes);
  const auto in = [head](std::uint32_t network, int bits) { return (head ^ network) >> (32 - bits) == 0; };
  return in(0x20000000, 3) && !in(0x20010000, 23) && !in(0x20010db8, 32) && !in(0x20020000, 16) && !in(0x3fff0000, 20);
}

struct FreeAddresses {
  void operator()(addrinfo* list) const { ::freeaddrinfo(list); }
};

std::string NumericHost(const addrinfo& info) {
  std::array<char, NI_MAXHOST> text{};
  const int error = ::getnameinfo(info.ai_addr, info.ai_addrlen, text.data(), text.size(), nullptr, 0, NI_NUMERICHOST);
  return error == 0 ? text.data() : "";
}

/// Takes "host", "[::1]", with ":port" behind, apart.
Status ReadAuthority(std::string_view authority, OutsideUrl& url) {
  std::string_view port;
  if (authority.starts_with('[')) {
    const std::size_t close = authority.find(']');
    if (close == std::string_view::npos) return BadUrl("a bracket is open");
    url.host = authority.substr(1, close - 1);
    port = authority.substr(close + 1);
  } else {
    const std::size_t colon = std::min(authority.find(':'), authority.size());
    url.host = authority.substr(0, colon);
    port = authority.substr(colon);
  }
  const bool good_host = std::all_of(url.host.begin(), url.host.end(), [](char c) {
    return std::isalnum(static_cast<unsigned char>(c)) != 0 || c == '.' || c == '-' || c == ':' || c == '_';
  });
  if (url.host.empty() || !good_host) return BadUrl("the host");
  if (port.empty()) return Status::Ok();
  const auto [end, error] = std::from_chars(port.data() + 1, port.data() + port.size(), url.port);
  if (port.front() != ':' || error != std::errc() || end != port.data() + port.size() || url.port < 1 ||
      url.port > 65535) {
    return BadUrl("the port");
  }
  return Status::Ok();
}

}  // namespace

Result<OutsideUrl> ParseOutsideUrl(std::string_view text) {
  if (text.size() > kMaxUrlBytes) return BadUrl("it is longer than " + std::to_string(kMaxUrlBytes) + " characters");
  if (!std::all_of(text.begin(), text.end(), [](char c) { return c > 0x20 && c < 0x7f && c != '#' && c != '@'; })) {
    return BadUrl("a character that must not be in it");
  }
  OutsideUrl url;
  url.tls = text.starts_with("https://");
  if (!url.tls && !text.starts_with("http://")) return BadUrl("it begins otherwise");
  url.port = url.tls ? kHttpsPort : kHttpPort;
  text.remove_prefix(url.tls ? 8 : 7);
  const std::size_t slash = std::min(text.find_first_of("/?"), text.size());
  DRUPE_RETURN_IF_ERROR(ReadAuthority(text.substr(0, slash), url));
  url.path = text.substr(slash);
  if (!url.path.starts_with('/')) url.path.insert(0, 1, '/');
  return url;
}

bool IsPublicAddress(const std::string& address) {
  in_addr v4{};
  if (::inet_pton(AF_INET, address.c_str(), &v4) == 1) return IsPublicV4(ntohl(v4.s_addr));
  in6_addr v6{};
  return ::inet_pton(AF_INET6, address.c_str(), &v6) == 1 && IsPublicV6(v6.s6_addr);
}

Result<std::string> ResolveOutside(const OutsideUrl& url, const std::set<std::string>& allowed_hosts) {
  addrinfo hints{};
  hints.ai_socktype = SOCK_STREAM;
  addrinfo* found = nullptr;
  if (const int error = ::getaddrinfo(url.host.c_str(), nullptr, &hints, &found)) {
    return Status(StatusKind::kUnavailable, "unreachable", url.host + ": " + ::gai_strerror(error));
  }
  const std::unique_ptr<addrinfo, FreeAddresses> list(found);
  std::string first;
  for (const addrinfo* info = found; info != nullptr; info = info->ai_next) {
    const std::string address = NumericHost(*info);
    if (!allowed_hosts.contains(url.host) && !IsPublicAddress(address)) {
      return Status(StatusKind::kForbidden, "webhook_refused",
                    url.host + " is " + address +
                        ", which is no public address; the option --webhook-allow names hosts "
                        "that may be called nevertheless",
                    "webhook");
    }
    if (first.empty()) first = address;
  }
  return first;
}

}  // namespace drupe
