#include "cli/bench/openmvg_peer.h"

#include <gtest/gtest.h>

#include "cli/bench/fake_programs.h"
#include "cli/bench/neighbour_pairs.h"

namespace drupe {
namespace {

/// What OpenMVG 2 writes of three pictures of which it has placed two.
constexpr const char* kSfmData = R"({
 "sfm_data_version": "0.3", "root_path": "images",
 "views": [
  {"key": 0, "value": {"polymorphic_id": 1073741824, "ptr_wrapper": {"id": 2147483649, "data": {"local_path": "",
   "filename": "00.jpg", "width": 1280, "height": 720, "id_view": 0, "id_intrinsic": 0, "id_pose": 0}}}},
  {"key": 1, "value": {"polymorphic_id": 1073741824, "ptr_wrapper": {"id": 2147483650, "data": {"local_path": "",
   "filename": "01.jpg", "width": 1280, "height": 720, "id_view": 1, "id_intrinsic": 0, "id_pose": 1}}}},
  {"key": 2, "value": {"polymorphic_id": 1073741824, "ptr_wrapper": {"id": 2147483651, "data": {"local_path": "",
   "filename": "02.jpg", "width": 1280, "height": 720, "id_view": 2, "id_intrinsic": 0, "id_pose": 2}}}}],
 "intrinsics": [
  {"key": 0, "value": {"polymorphic_id": 2147483649, "polymorphic_name": "pinhole_brown_t2", "ptr_wrapper":
   {"id": 2147483652, "data": {"value0": {"width": 1280, "height": 720, "focal_length": 1886.2,
    "principal_point": [632.0, 359.0]}, "disto_t2": [0.0, 0.0, 0.0, 0.0, 0.0]}}}}],
 "extrinsics": [
  {"key": 0, "value": {"rotation": [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]], "center": [0.0, 0.0, 0.0]}},
  {"key": 2, "value": {"rotation": [[0.0, -1.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, 1.0]],
   "center": [1.0, 2.0, 3.0]}}],
 "structure": [{"key": 0, "value": {"X": [0.5, 0.5, 4.0], "observations": []}},
               {"key": 7, "value": {"X": [0.1, 0.5, 4.5], "observations": []}}],
 "control_points": []})";

/// Programs that stand where OpenMVG's would: the first and the last write the recorded file into out/.
void AddOpenMvg(const FakePrograms& fake) {
  fake.Write("recorded.json", kSfmData);
  const auto write_as = [&](const std::string& name) {
    return "/bin/cp " + fake.Path("recorded.json") + " " + fake.Path("out/" + name);
  };
  fake.Add("openMVG_main_SfMInit_ImageListing", write_as("sfm_data.json"));
  for (const std::string step : {"ComputeFeatures", "PairGenerator", "ComputeMatches", "GeometricFilter", "SfM"}) {
    fake.Add("openMVG_main_" + step, ":");
  }
  fake.Add("openMVG_main_ConvertSfM_DataFormat", write_as("model.json"));
}

TruthSet SetOfThree() {
  TruthSet set;
  set.directory = "/sets/three";
  set.input.calibration.emplace();
  PinholeCamera& camera = set.input.calibration->camera;
  camera.width = 1280, camera.height = 720;
  camera.fx = 1886, camera.fy = 1888, camera.cx = 632, camera.cy = 359;
  camera.dist = {-0.06, 0.01, 0.002, 0.003, 0.004};
  return set;
}

TEST(OpenMvgPeer, ReadsPosesOfTheViewsThatHaveOne) {
  const auto views = ParseOpenMvgViews(Json::parse(kSfmData));
  ASSERT_TRUE(views.ok()) << views.status().ToString();
  ASSERT_EQ(views->size(), 3u);
  EXPECT_FALSE((*views)[1].cam_from_world.has_value());
  ASSERT_TRUE((*views)[2].cam_from_world.has_value());
  EXPECT_EQ((*views)[2].image, "02.jpg");
  EXPECT_LT(((*views)[2].cam_from_world->Centre() - Eigen::Vector3d(1, 2, 3)).norm(), 1e-12);
  EXPECT_EQ((*views)[2].cam_from_world->translation, Eigen::Vector3d(2, -1, -3));
}

TEST(OpenMvgPeer, RefusesWhatIsNoModel) {
  EXPECT_EQ(ParseOpenMvgViews(Json::parse("{}")).status().code(), "bad_peer_model");
  Json other = Json::parse(R"({"intrinsics": [{"key": 0}]})");
  EXPECT_EQ(SetOpenMvgLens(PinholeCamera(), other).code(), "bad_peer_model");
}

TEST(OpenMvgPeer, RunsItsProgramsWithTheWholeLens) {
  const FakePrograms fake;
  EXPECT_FALSE(HasOpenMvg());
  AddOpenMvg(fake);
  ASSERT_TRUE(HasOpenMvg());
  const Result<SfmRun> run = RunOpenMvg(SetOfThree(), fake.Path("out"));
  ASSERT_TRUE(run.ok()) << run.status().ToString();
  EXPECT_EQ(run->views.size(), 3u);
  EXPECT_EQ(run->points, 2u);
  const std::string arguments = fake.Read("arguments");
  EXPECT_NE(arguments.find("-i /sets/three/images"), std::string::npos) << arguments;
  EXPECT_NE(arguments.find("-k 1887;0;632;0;1887;359;0;0;1 -c 4"), std::string::npos) << arguments;
  EXPECT_NE(arguments.find("SfM -s INCREMENTAL"), std::string::npos) << arguments;
  const Json list = Json::parse(fake.Read("out/sfm_data.json"));
  EXPECT_EQ(list["intrinsics"][0]["value"]["ptr_wrapper"]["data"]["disto_t2"],
            Json::parse("[-0.06, 0.01, 0.004, 0.002, 0.003]"));
}

TEST(OpenMvgPeer, SaysWhichProgramFailed) {
  const FakePrograms fake;
  AddOpenMvg(fake);
  fake.Add("openMVG_main_ComputeMatches", "exit 4");
  const Result<SfmRun> run = RunOpenMvg(SetOfThree(), fake.Path("out"));
  EXPECT_EQ(run.status().code(), "peer_failed");
  EXPECT_NE(run.status().message().find("ComputeMatches"), std::string::npos);
}

TEST(NeighbourPairs, CloseTheRing) {
  const std::vector<ImagePair> expected = {{0, 1}, {0, 3}, {1, 2}, {2, 3}};
  EXPECT_EQ(NeighbourPairs(4, 1), expected);
  EXPECT_EQ(NeighbourPairs(3, 9).size(), 3u);
  EXPECT_TRUE(NeighbourPairs(1, 1).empty());
}

}  // namespace
}  // namespace drupe
