#include "cli/progress_bar.h"

#include <gtest/gtest.h>

#include <limits>
#include <sstream>
#include <thread>
#include <vector>

namespace drupe {
namespace {

/// A bar on a string, with a clock that the test moves.
class ProgressBarTest : public testing::Test {
 protected:
  ProgressBarOptions Options(bool redraw) {
    ProgressBarOptions options;
    options.redraw = redraw;
    options.bar_width = 10;
    options.now_s = [this] { return now_s_; };
    return options;
  }

  std::ostringstream out_;
  double now_s_ = 100;
};

TEST_F(ProgressBarTest, PlainWritesOneLineAStage) {
  ProgressBar bar(out_, Options(false));
  bar.Update("features", 0);
  now_s_ += 1.5;
  bar.Update("features", 1);
  bar.Update("dense", 0.25);
  now_s_ += 12;
  bar.Finish();
  EXPECT_EQ(out_.str(),
            "features           1.5 s\n"
            "dense             12.0 s\n");
}

TEST_F(ProgressBarTest, RedrawShowsStageShareAndTime) {
  ProgressBar bar(out_, Options(true));
  bar.Update("dense", 0);
  now_s_ += 3;
  bar.Update("dense", 0.579);
  EXPECT_TRUE(out_.str().ends_with("\r\x1b[Kdense         [######....]   57 %     3.0 s")) << out_.str();
  bar.Finish();
  EXPECT_TRUE(out_.str().ends_with("\r\x1b[Kdense              3.0 s\n")) << out_.str();
}

TEST_F(ProgressBarTest, RedrawDropsUpdatesThatComeTooSoonButNotTheLast) {
  ProgressBar bar(out_, Options(true));
  bar.Update("dense", 0);
  const std::string before = out_.str();
  now_s_ += 0.01;
  bar.Update("dense", 0.5);
  EXPECT_EQ(out_.str(), before);
  bar.Update("dense", 1);
  EXPECT_NE(out_.str().find("100 %"), std::string::npos);
}

TEST_F(ProgressBarTest, ClampsFractions) {
  ProgressBar bar(out_, Options(true));
  bar.Update("a", -1);
  bar.Update("b", 7);
  bar.Update("c", std::numeric_limits<double>::quiet_NaN());
  EXPECT_NE(out_.str().find("a             [..........]    0 %"), std::string::npos) << out_.str();
  EXPECT_NE(out_.str().find("b             [##########]  100 %"), std::string::npos) << out_.str();
  EXPECT_NE(out_.str().find("c             [..........]    0 %"), std::string::npos) << out_.str();
}

TEST_F(ProgressBarTest, LeavesTheCursorOnALineOfItsOwn) {
  {
    ProgressBar bar(out_, Options(true));
    bar.Update("dense", 0.5);
  }
  EXPECT_TRUE(out_.str().ends_with("\n"));
}

TEST_F(ProgressBarTest, NothingShownWhenNothingRan) {
  {
    ProgressBar bar(out_, Options(true));
    bar.Finish();
  }
  EXPECT_EQ(out_.str(), "");
}

TEST_F(ProgressBarTest, TakesUpdatesFromManyThreads) {
  ProgressBar bar(out_, Options(false));
  std::vector<std::jthread> threads;
  for (int t = 0; t < 4; ++t) {
    threads.emplace_back([&bar] {
      for (int i = 0; i <= 1000; ++i) bar.Update("dense", i / 1000.0);
    });
  }
  threads.clear();
  bar.Finish();
  EXPECT_EQ(out_.str(), "dense              0.0 s\n");
}

}  // namespace
}  // namespace drupe
