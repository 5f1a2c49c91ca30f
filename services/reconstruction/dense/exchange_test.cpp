#include "reconstruction/dense/exchange.h"

#include <gtest/gtest.h>

#include "reconstruction/dense/ball_level.h"
#include "reconstruction/dense/expansion.h"

namespace drupe::dense {
namespace {

const BallLevel& LevelBall() {
  return BallLevel::Get();
}

/// The maps of all views, grown by themselves except that of `left_out`, which stays empty.
std::vector<PatchMap> GrownMaps(int left_out) {
  std::vector<PatchMap> maps;
  const int views = static_cast<int>(LevelBall().loaded.views.size());
  for (int view = 0; view < views; ++view) {
    maps.push_back(LevelBall().context.EmptyMap(view));
    if (view == left_out) continue;
    PlaceGuesses(LevelBall().context, view, SeedGuesses(LevelBall().context, view, maps.back()), 0.5f, {},
                 &maps.back());
    Expand(LevelBall().context, view, {}, &maps.back());
  }
  return maps;
}

TEST(ExchangePatches, FillsAViewFromWhatItsNeighboursFound) {
  std::vector<PatchMap> maps = GrownMaps(0);
  const int beside = LevelBall().Count(1, maps[1]).all;
  ASSERT_GT(beside, 1000);
  ASSERT_TRUE(ExchangePatches(LevelBall().context, {}, &maps).ok());
  const BallLevel::Filled filled = LevelBall().Count(0, maps[0]);
  EXPECT_GT(filled.all, 0.9 * beside);
  EXPECT_GT(filled.right, 0.98 * filled.all);
}

TEST(ExchangePatches, LeavesAViewsOwnPatchesAsTheyAre) {
  const std::vector<PatchMap> before = GrownMaps(-1);
  std::vector<PatchMap> maps = before;
  ASSERT_TRUE(ExchangePatches(LevelBall().context, {}, &maps).ok());
  for (std::size_t i = 0; i < maps[3].cells.size(); ++i) {
    if (!before[3].cells[i].Filled()) continue;
    ASSERT_EQ(maps[3].cells[i].w, before[3].cells[i].w) << i;
  }
}

TEST(ExchangePatches, HasNothingToOfferWithoutPatches) {
  std::vector<PatchMap> maps;
  for (int view = 0; view < static_cast<int>(LevelBall().loaded.views.size()); ++view) {
    maps.push_back(LevelBall().context.EmptyMap(view));
  }
  ASSERT_TRUE(ExchangePatches(LevelBall().context, {}, &maps).ok());
  EXPECT_EQ(LevelBall().Count(0, maps[0]).all, 0);
}

}  // namespace
}  // namespace drupe::dense
