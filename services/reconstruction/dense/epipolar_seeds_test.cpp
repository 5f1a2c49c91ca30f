#include "reconstruction/dense/epipolar_seeds.h"

#include <gtest/gtest.h>

#include "reconstruction/dense/ball_level.h"

namespace drupe::dense {
namespace {

class EpipolarSeeds : public testing::Test {
 protected:
  EpipolarSeeds() {
    for (const RefinerFrame& frame : context_.frames) corners_.push_back(FindCorners(frame.reference, 4));
  }

  const LevelContext& context_ = BallLevel::Get().context;
  std::vector<std::vector<Eigen::Vector2i>> corners_;  ///< of every view
  PatchMap map_ = context_.EmptyMap(0);
};

TEST_F(EpipolarSeeds, FindSurfaceWithoutTracks) {
  EXPECT_GT(corners_[0].size(), 20u);
  const std::vector<PatchGuess> guesses = EpipolarGuesses(context_, 0, corners_, map_);
  ASSERT_GT(guesses.size(), 50u);
  PlaceGuesses(context_, 0, guesses, 0.5f, {}, &map_);
  const BallLevel::Filled filled = BallLevel::Get().Count(0, map_);
  EXPECT_GT(filled.all, 15);
  EXPECT_GT(filled.right, 0.8 * filled.all);
}

TEST_F(EpipolarSeeds, LeaveAloneWhatHasPatches) {
  for (PatchCell& cell : map_.cells) cell.ncc = 0.9f;
  EXPECT_TRUE(EpipolarGuesses(context_, 0, corners_, map_).empty());
}

}  // namespace
}  // namespace drupe::dense
