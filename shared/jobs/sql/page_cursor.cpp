#include "jobs/sql/page_cursor.h"

#include <charconv>
#include <limits>

namespace drupe {

Result<std::int64_t> ParseCursor(const std::string& cursor) {
  std::int64_t seq = std::numeric_limits<std::int64_t>::max();
  if (cursor.empty()) return seq;
  const auto [end, error] = std::from_chars(cursor.data(), cursor.data() + cursor.size(), seq);
  if (error == std::errc() && end == cursor.data() + cursor.size() && seq > 0) return seq;
  return InvalidArgument("invalid_cursor", "the cursor must be one that a former page returned", "cursor");
}

}  // namespace drupe
