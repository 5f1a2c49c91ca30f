#include "scene/sparse_export.h"

#include <gtest/gtest.h>

#include <cstring>

#include "scene/cameras_json.h"
#include "scene/small_model.h"
#include "scene/words.h"

namespace drupe {
namespace {

TEST(SparsePlyTest, NominalHoldsPositionsAndColours) {
  const std::string ply = SparsePly(SmallModel());
  const std::size_t body = ply.find("end_header\n") + 11;
  EXPECT_NE(ply.find("element vertex 2\n"), std::string::npos);
  ASSERT_EQ(ply.size() - body, 2u * 23);
  float position[3], quality[2];
  std::memcpy(position, ply.data() + body, sizeof position);
  EXPECT_EQ(position[2], -3.75f);
  EXPECT_EQ(static_cast<unsigned char>(ply[body + 12]), 200);
  std::memcpy(quality, ply.data() + body + 15, sizeof quality);
  EXPECT_EQ(quality[0], 0.0625f);
  EXPECT_EQ(quality[1], 0.5f);
}

TEST(NvmTest, NominalNumbersRegisteredViewsOnly) {
  const auto lines = Words(Nvm(SmallModel()));
  EXPECT_EQ(lines[0], (std::vector<std::string>{"NVM_V3"}));
  EXPECT_EQ(lines[2], (std::vector<std::string>{"2"}));
  EXPECT_EQ(lines[4][0], "2.jpg");
  EXPECT_EQ(lines[4].size(), 11u);
  EXPECT_EQ(lines[6], (std::vector<std::string>{"2"}));
  EXPECT_EQ(lines[7][6], "2");   // measurements
  EXPECT_EQ(lines[7][11], "1");  // "2.jpg" is the second camera
}

TEST(CamerasJsonTest, ReadsBackWhatItWrote) {
  const SparseModel model = SmallModel();
  const Json json = CamerasJson(model);
  EXPECT_EQ(json["unit"], "mm");
  EXPECT_FALSE(json["cameras"][1]["registered"].get<bool>());
  EXPECT_TRUE(json["cameras"][1]["R"].is_null());
  const auto read = ParseCameras(*ParseJson(DumpJson(json)));
  ASSERT_TRUE(read.ok()) << read.status().ToString();
  EXPECT_EQ(read->views[2].cam_from_world->translation, model.views[2].cam_from_world->translation);
  EXPECT_EQ(read->views[2].cam_from_world->rotation, model.views[2].cam_from_world->rotation);
  EXPECT_EQ(read->views[1].reason, model.views[1].reason);
  EXPECT_EQ(read->views[2].centre_sigma, 0.004);
  EXPECT_EQ(read->views[2].rotation_sigma_deg, 0.002);
  EXPECT_FALSE(json["cameras"][0].contains("centre_sigma"));  // not known
  EXPECT_EQ(read->camera.dist, model.camera.dist);
  EXPECT_EQ(read->scale_source, ScaleSource::kBoard);
}

TEST(CamerasJsonTest, NamesTheFieldThatIsWrong) {
  Json json = CamerasJson(SmallModel());
  json["cameras"][2]["R"][0][0] = 5;
  EXPECT_EQ(ParseCameras(json).status().field(), "cameras.2.R");
  json = CamerasJson(SmallModel());
  json["scale_source"] = "guess";
  EXPECT_EQ(ParseCameras(json).status().field(), "scale_source");
  EXPECT_EQ(ParseCameras(Json::array()).status().code(), "invalid_cameras");
}

TEST(ColourTracksTest, MiddleObservationDecides) {
  SparseModel model = SmallModel();
  RgbImage image(640, 480, 3);
  for (int y = 0; y < 480; ++y) {
    for (int x = 0; x < 640; ++x) {
      for (int c = 0; c < 3; ++c) image.At(x, y, c) = static_cast<std::uint8_t>(10 * c + x / 4);
    }
  }
  ColourTracks(model, 0, image);
  EXPECT_EQ(model.tracks[0].colour[0], 200);  // its middle observation is in view 2
  ColourTracks(model, 2, image);
  EXPECT_EQ(model.tracks[1].colour[0], 6);
  EXPECT_EQ(model.tracks[1].colour[2], 26);
}

}  // namespace
}  // namespace drupe
