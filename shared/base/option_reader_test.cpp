#include "base/option_reader.h"

#include <gtest/gtest.h>

namespace drupe {
namespace {

TEST(OptionReader, ReadsWhatIsThereAndKeepsDefaults) {
  const Json json = {{"count", 7}, {"ratio", 0.5}, {"inner", {{"on", true}}}};
  OptionReader reader(json, "");
  int count = 1, other = 3;
  double ratio = 0;
  reader.Read("count", count);
  reader.Read("other", other);
  reader.Read("ratio", ratio);
  const Json* inner = reader.Nested("inner");
  ASSERT_NE(inner, nullptr);
  OptionReader inner_reader(*inner, reader.PathOf("inner"));
  bool on = false;
  inner_reader.Read("on", on);
  EXPECT_TRUE(inner_reader.Finish().ok());
  EXPECT_TRUE(reader.Finish().ok());
  EXPECT_EQ(count, 7);
  EXPECT_EQ(other, 3);
  EXPECT_EQ(ratio, 0.5);
  EXPECT_TRUE(on);
}

TEST(OptionReader, UnknownKeyIsNamedWithItsPath) {
  const Json json = {{"levle", 1}};
  OptionReader reader(json, "options.dense");
  int level = 0;
  reader.Read("level", level);
  const Status status = reader.Finish();
  EXPECT_EQ(status.code(), "unknown_option");
  EXPECT_EQ(status.field(), "options.dense.levle");
  EXPECT_NE(status.message().find("known here: level"), std::string::npos);
}

TEST(OptionReader, WrongTypesAreRefused) {
  for (const Json& bad : {Json("7"), Json(7.5), Json(true), Json(1e30), Json(nullptr)}) {
    const Json json = {{"count", bad}};
    OptionReader reader(json, "");
    int count = 1;
    reader.Read("count", count);
    EXPECT_EQ(reader.Finish().code(), "invalid_option") << bad.dump();
    EXPECT_EQ(count, 1);
  }
}

TEST(OptionReader, AnythingButAnObjectIsRefused) {
  const Json json = Json::array();
  OptionReader reader(json, "options");
  EXPECT_FALSE(reader.Finish().ok());
}

}  // namespace
}  // namespace drupe
