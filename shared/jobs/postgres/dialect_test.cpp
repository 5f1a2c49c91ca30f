#include "jobs/postgres/dialect.h"

#include <gtest/gtest.h>

namespace drupe {
namespace {

TEST(NumberParameters, CountsWhatIsOutsideQuotes) {
  EXPECT_EQ(NumberParameters("a = ? AND b IN (?, ?)"), "a = $1 AND b IN ($2, $3)");
  EXPECT_EQ(NumberParameters("a = '?' AND b = ?"), "a = '?' AND b = $1");
}

TEST(TranslateSchema, SpeaksPostgres) {
  EXPECT_EQ(TranslateSchema("CREATE TABLE t (seq INTEGER PRIMARY KEY AUTOINCREMENT, n INTEGER, x REAL);"),
            "CREATE TABLE t (seq BIGINT GENERATED ALWAYS AS IDENTITY PRIMARY KEY, n BIGINT, x DOUBLE PRECISION);");
  EXPECT_EQ(TranslateSchema("CREATE TABLE t (id TEXT PRIMARY KEY) WITHOUT ROWID;"),
            "CREATE TABLE t (id TEXT PRIMARY KEY);");
}

TEST(StorableText, KeepsUtf8AndReplacesTheRest) {
  EXPECT_EQ(StorableText("plum \xC3\xBC \xE2\x82\xAC \xF0\x9F\x8D\x91"), "plum \xC3\xBC \xE2\x82\xAC \xF0\x9F\x8D\x91");
  EXPECT_EQ(StorableText(std::string_view("a\0b", 3)),
            "a\xEF\xBF\xBD"
            "b");
  EXPECT_EQ(StorableText("\xFF"), "\xEF\xBF\xBD");
  EXPECT_EQ(StorableText("\xC0\x80"), "\xEF\xBF\xBD\xEF\xBF\xBD") << "overlong";
  EXPECT_EQ(StorableText("\xED\xA0\x80"), "\xEF\xBF\xBD\xEF\xBF\xBD\xEF\xBF\xBD") << "a surrogate";
  EXPECT_EQ(StorableText("a\xE2\x82"), "a\xEF\xBF\xBD\xEF\xBF\xBD") << "cut off";
}

}  // namespace
}  // namespace drupe
