#include "base/clock.h"

#include <gtest/gtest.h>

namespace drupe {
namespace {

TEST(ParseUtcTest, ReadsWhatFormatUtcWrites) {
  for (const std::int64_t ms : {0LL, 1'763'720'130'123LL, 4'102'444'799'999LL}) {
    EXPECT_EQ(ParseUtc(FormatUtc(ms)).value(), ms);
  }
  EXPECT_EQ(ParseUtc("2025-11-21T10:15:30Z").value(), 1'763'720'130'000);
  EXPECT_EQ(ParseUtc("2025-11-21").value(), 1'763'683'200'000);
}

TEST(ParseUtcTest, RefusesEverythingElse) {
  for (const char* text : {"", "yesterday", "2025-02-30", "2025-13-01", "2025-11-21T24:00:00Z", "2025-11-21T10:15:30",
                           "2025-11-21T10:15:30.1Z", "-025-11-21", "2025-11-21 ", "2025-11-21T10:60:00Z"}) {
    EXPECT_EQ(ParseUtc(text).status().code(), "invalid_time") << text;
  }
}

}  // namespace
}  // namespace drupe
