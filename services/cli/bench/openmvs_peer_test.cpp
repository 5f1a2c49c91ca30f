#include "cli/bench/openmvs_peer.h"

#include <gtest/gtest.h>

#include "cli/bench/fake_programs.h"
#include "cli/bench/ply_positions.h"
#include "image/encode.h"

namespace drupe {
namespace {

template <typename T>
void Append(T value, std::string* bytes) {
  bytes->append(reinterpret_cast<const char*>(&value), sizeof(value));
}

/// Two points as OpenMVS writes them, the views of each as lists.
std::string DensePly() {
  std::string ply =
      "ply\nformat binary_little_endian 1.0\nelement vertex 2\nproperty float32 x\nproperty float32 y\n"
      "property float32 z\nproperty uint8 red\nproperty list uint8 uint32 view_indices\n"
      "property list uint8 float32 view_weights\nelement face 1\nproperty list uint8 int32 vertex_indices\n"
      "end_header\n";
  for (int point = 0; point < 2; ++point) {
    for (const float value : {1.5f, 2.5f, 3.5f + static_cast<float>(point)}) Append(value, &ply);
    Append<std::uint8_t>(200, &ply);
    const auto views = static_cast<std::uint8_t>(point + 2);
    Append(views, &ply);
    for (std::uint32_t i = 0; i < views; ++i) Append(i, &ply);
    Append(views, &ply);
    for (std::uint32_t i = 0; i < views; ++i) Append(0.5f, &ply);
  }
  return ply;
}

/// A set of one picture of 8 x 6 pixels, and a model that has placed it.
TruthSet OnePicture() {
  TruthSet set;
  RgbImage picture(8, 6, 3);
  const std::string png = EncodePng(picture).value();
  set.input.images.push_back({"a.png", [png]() -> Result<std::string> { return png; }});
  return set;
}

SparseModel OneView() {
  SparseModel model;
  model.camera = {8, 6, 10, 11, 3.5, 2.5, {}};
  View view;
  view.image = "a.png";
  view.cam_from_world = Rigid3();
  view.cam_from_world->translation = Eigen::Vector3d(1, 2, 3);
  model.views = {view, View()};  // the other is not registered
  Track track;
  track.position = Eigen::Vector3d(0.5, 0.25, 4);
  track.observations.emplace_back();
  model.tracks = {track};
  return model;
}

TEST(OpenMvsPeer, GivesItsProgramsTheSceneAndReadsTheCloud) {
  const FakePrograms fake;
  EXPECT_FALSE(HasOpenMvs());
  fake.Write("recorded.ply", DensePly());
  fake.Add("InterfaceCOLMAP", "test -s \"$2/images/00000000.png\" || exit 3");
  fake.Add("DensifyPointCloud", "/bin/cp " + fake.Path("recorded.ply") + " \"$2/scene_dense.ply\"");
  ASSERT_TRUE(HasOpenMvs());
  const Result<PeerCloud> peer = RunOpenMvs(OnePicture(), OneView(), fake.Path("work"), 2);
  ASSERT_TRUE(peer.ok()) << peer.status().ToString();
  ASSERT_EQ(peer->cloud.size(), 2u);
  EXPECT_EQ(peer->cloud.positions[1], Eigen::Vector3f(1.5f, 2.5f, 4.5f));
  EXPECT_EQ(fake.Read("work/sparse/cameras.txt"), "1 PINHOLE 8 6 10 11 4 3\n");
  EXPECT_EQ(fake.Read("work/sparse/images.txt"), "1 1 0 0 0 1 2 3 1 00000000.png\n\n");
  EXPECT_EQ(fake.Read("work/sparse/points3D.txt"), "1 0.5 0.25 4 0 0 0 0 1 0\n");
  const std::string arguments = fake.Read("arguments");
  EXPECT_NE(arguments.find("--max-threads 2", arguments.find("DensifyPointCloud ")), std::string::npos) << arguments;
}

TEST(OpenMvsPeer, SaysWhichProgramFailed) {
  const FakePrograms fake;
  fake.Add("InterfaceCOLMAP", ":");
  fake.Add("DensifyPointCloud", "exit 4");
  const Result<PeerCloud> failed = RunOpenMvs(OnePicture(), OneView(), fake.Path("work"), 1);
  EXPECT_EQ(failed.status().code(), "peer_failed");
  EXPECT_NE(failed.status().message().find("DensifyPointCloud"), std::string::npos);
  fake.Add("DensifyPointCloud", ":");
  EXPECT_EQ(RunOpenMvs(OnePicture(), OneView(), fake.Path("work"), 1).status().code(), "peer_failed");
}

TEST(PlyPositions, ReadsWhatPmvsWrites) {
  const Result<PointCloud> cloud = ReadPlyPositions(
      "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\n"
      "property float nx\nproperty uchar diffuse_red\nend_header\n1 2 3 0 9\nnan 2 3 0 9\n-4.5 5 6e-1 0 9\n");
  ASSERT_TRUE(cloud.ok()) << cloud.status().ToString();
  ASSERT_EQ(cloud->size(), 2u);
  EXPECT_EQ(cloud->positions[1], Eigen::Vector3f(-4.5f, 5, 0.6f));
}

TEST(PlyPositions, RefusesWhatIsCutOffOrNoPly) {
  std::string ply = DensePly();
  ply.pop_back();
  for (const std::string& bad : {std::string(), std::string("ply\nformat ascii 1.0\n"), ply,
                                 std::string("ply\nformat binary_big_endian 1.0\nelement vertex 1\nend_header\n"),
                                 std::string("ply\nformat ascii 1.0\nelement vertex 9999999999\nend_header\n")}) {
    EXPECT_EQ(ReadPlyPositions(bad).status().code(), "bad_ply");
  }
}

}  // namespace
}  // namespace drupe
