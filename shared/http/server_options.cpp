#include "http/server.h"

namespace drupe {

Status ServerOptions::Check() const {
  const auto check = [](bool good, const char* name, const char* allowed) {
    return good ? Status::Ok() : InvalidArgument("invalid_option", std::string(name) + " must be " + allowed, name);
  };
  DRUPE_RETURN_IF_ERROR(check(port >= 0 && port <= 65535, "port", "0 to 65535"));
  DRUPE_RETURN_IF_ERROR(check(!host.empty(), "host", "an address"));
  DRUPE_RETURN_IF_ERROR(check(max_connections >= 1 && max_connections <= 4096, "max_connections", "1 to 4096"));
  DRUPE_RETURN_IF_ERROR(
      check(reserved_connections >= 0 && reserved_connections <= 256, "reserved_connections", "0 to 256"));
  DRUPE_RETURN_IF_ERROR(check(max_concurrent_uploads >= 1, "max_concurrent_uploads", "at least 1"));
  DRUPE_RETURN_IF_ERROR(check(min_body_bytes_per_s >= 1, "min_body_bytes_per_s", "at least 1"));
  return check(max_requests_per_connection >= 1, "max_requests_per_connection", "at least 1");
}

}  // namespace drupe
