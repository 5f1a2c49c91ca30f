#include "cli/bench/colmap_peer.h"

#include <gtest/gtest.h>

namespace drupe {
namespace {

TEST(ColmapPeer, ReadsPosesAndCountsPoints) {
  const auto views = ParseColmapImages(
      "# Image list\n"
      "1 0.5 0.5 0.5 0.5 1 2 3 1 00.jpg\n"
      "10.5 20.5 -1 30 40 7\n"
      "2 1 0 0 0 0 0 5 1 01.jpg\n"
      "\n"
      "3 1 0 0 0 0 0 6 1 02.jpg\n"
      "1 2 3\n");
  ASSERT_TRUE(views.ok());
  ASSERT_EQ(views->size(), 3u);
  EXPECT_EQ((*views)[2].image, "02.jpg");
  EXPECT_EQ((*views)[0].cam_from_world->translation, Eigen::Vector3d(1, 2, 3));
  EXPECT_LT(((*views)[0].cam_from_world->rotation * Eigen::Vector3d(1, 0, 0) - Eigen::Vector3d(0, 1, 0)).norm(), 1e-12);
  EXPECT_EQ(CountColmapPoints("# 3D points\n1 0 0 0 1 2 3 0.5 1 2\n2 0 0 0 1 2 3 0.5 1 2\n"), 2u);
}

TEST(ColmapPeer, RefusesWhatIsNoModel) {
  EXPECT_EQ(ParseColmapImages("1 0.5 0.5 name\n\n").status().code(), "bad_peer_model");
}

TEST(ColmapPeer, GivesTheWholeLens) {
  PinholeCamera camera;
  camera.fx = 1800, camera.fy = 1801, camera.cx = 640, camera.cy = 360;
  camera.dist = {-0.1, 0.01, 0.001, 0.002, 0};
  EXPECT_EQ(ColmapCameraOf(camera).model, "OPENCV");
  EXPECT_EQ(ColmapCameraOf(camera).parameters, "1800,1801,640.5,360.5,-0.1,0.01,0.001,0.002");
  camera.dist[4] = 0.03;
  EXPECT_EQ(ColmapCameraOf(camera).model, "FULL_OPENCV");
  EXPECT_EQ(ColmapCameraOf(camera).parameters, "1800,1801,640.5,360.5,-0.1,0.01,0.001,0.002,0.03,0,0,0");
}

}  // namespace
}  // namespace drupe
