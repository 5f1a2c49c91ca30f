#include <gtest/gtest.h>

#include "capture/turntable/external_turntable.h"
#include "capture/turntable/grbl_turntable.h"

namespace drupe {
namespace {

TEST(GrblStatusTest, ReadsMachineAndWorkPositions) {
  const auto idle = ParseGrblStatus("<Idle|MPos:0.000,0.000,0.000,10.500|FS:0,0>", 'A');
  ASSERT_TRUE(idle);
  EXPECT_EQ(idle->state, "Idle");
  EXPECT_DOUBLE_EQ(idle->position, 10.5);
  const auto held = ParseGrblStatus("<Hold:1|WPos:1.0,-2.5|WCO:0.5,3.0>", 'Y');
  ASSERT_TRUE(held);
  EXPECT_EQ(held->state, "Hold");
  EXPECT_DOUBLE_EQ(held->position, 0.5);
}

TEST(GrblStatusTest, TakesNothingElse) {
  for (const char* line : {"", "ok", "<", "<>", "<Idle>", "<Idle|MPos:>", "<Idle|MPos:1,2,3|FS:0,0>", "[MSG:<Idle|]",
                           "<Idle|MPos:1,2,x,4>"}) {
    EXPECT_FALSE(ParseGrblStatus(line, 'A')) << line;
  }
}

TEST(TurntableTest, RefusesBadOptionsAndLines) {
  EXPECT_EQ(TurntableOptions{.speed_deg_s = 0}.Check().field(), "speed_deg_s");
  EXPECT_EQ(TurntableOptions{.settle_ms = -1}.Check().field(), "settle_ms");
  EXPECT_TRUE(TurntableOptions{}.Check().ok());
  const auto absent = GrblTurntable::Open({.device = "/dev/no-such-table"}, {});
  EXPECT_EQ(absent.status().code(), "table_unreachable");
  EXPECT_EQ(GrblTurntable::Open({.device = "/dev/null"}, {}).status().code(), "table_unreachable");
  EXPECT_EQ(GrblTurntable::Open({.axis = 'Q'}, {}).status().field(), "axis");
  EXPECT_EQ(GrblTurntable::Open({.baud = 1}, {}).status().field(), "baud");
}

TEST(TurntableTest, ATableThatTurnsByItselfFollowsTheTime) {
  ExternalTurntable table;
  ASSERT_TRUE(table.Prepare().ok());
  EXPECT_FALSE(table.Read()->moving);
  EXPECT_EQ(table.MoveTo(10, nullptr).code(), "table_refused");
  ASSERT_TRUE(table.StartTurn(360, 1e6).ok());
  const double before = table.Read()->angle_deg;
  EXPECT_GT(table.Read()->angle_deg, before);
}

}  // namespace
}  // namespace drupe
