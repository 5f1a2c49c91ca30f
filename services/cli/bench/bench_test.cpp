#include <gtest/gtest.h>

#include <cstdio>
#include <filesystem>

#include "cli/bench/peer_process.h"
#include "cli/bench/text_table.h"
#include "cli/bench/truth_set.h"

namespace drupe {
namespace {

const std::string kSample = std::string(DRUPE_TEST_DATA) + "/plum-s";

TEST(TextTable, AlignsColumnsUnderTheirHeading) {
  EXPECT_EQ(FormatTextTable({"set", "mm"}, {{"plum-s", "0.5"}, {"a", "12.25"}}),
            "set        mm\n------  -----\nplum-s    0.5\na       12.25\n");
}

TEST(PeerProcess, ReportsTheExitCodeAndTheCpuTime) {
  const std::string log = (std::filesystem::temp_directory_path() / "drupe_peer_test.log").string();
  const Result<PeerRun> run = RunPeer({"sh", "-c", "i=0; while [ $i -lt 200000 ]; do i=$((i+1)); done; exit 3"}, log);
  ASSERT_TRUE(run.ok());
  EXPECT_EQ(run->exit_code, 3);
  EXPECT_GT(run->cpu_s, 0.01);
  EXPECT_FALSE(RunPeer({"drupe-no-such-program"}, log).ok());
  EXPECT_FALSE(FindProgram("drupe-no-such-program").has_value());
  EXPECT_TRUE(FindProgram("sh").has_value());
  std::remove(log.c_str());
}

TEST(TruthSet, TruePosesHaveNoErrorInAnyFrame) {
  const Result<TruthSet> set = LoadTruthSet(kSample);
  ASSERT_TRUE(set.ok()) << set.status().message();
  EXPECT_EQ(set->name, "plum-s");
  EXPECT_EQ(set->input.images.size(), 36u);
  const Sim3 model_from_truth{0.25, set->views[3].cam_from_world.rotation, Eigen::Vector3d(1, -2, 3)};
  std::vector<View> views;
  for (const TrueView& view : set->views) {
    views.push_back({view.image, TransformPose(view.cam_from_world, model_from_truth), "", 0, 0});
  }
  views.pop_back();
  const Result<PoseErrors> errors = ComparePoses(*set, views);
  ASSERT_TRUE(errors.ok());
  EXPECT_EQ(errors->registered, 35);
  EXPECT_EQ(errors->of, 36);
  EXPECT_LT(errors->max_centre_mm, 1e-6);
  EXPECT_LT(errors->max_rotation_deg, 1e-5);
  EXPECT_NEAR(errors->truth_from_model.scale, 4.0, 1e-9);
}

TEST(TruthSet, AMissingFileIsNamed) {
  const Result<TruthSet> set = LoadTruthSet(std::string(DRUPE_TEST_DATA) + "/plum-s/images");
  ASSERT_FALSE(set.ok());
  EXPECT_NE(set.status().message().find("images"), std::string::npos);
}

}  // namespace
}  // namespace drupe
