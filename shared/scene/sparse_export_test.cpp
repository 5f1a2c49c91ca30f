#include "scene/sparse_export.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cstring>
#include <map>
#include <sstream>

#include "scene/cameras_json.h"
#include "scene/zip_writer.h"

namespace drupe {
namespace {

/// Three views, the second not registered, and two tracks.
SparseModel SmallModel() {
  SparseModel model;
  model.camera = {.width = 640,
                  .height = 480,
                  .fx = 800,
                  .fy = 810,
                  .cx = 320.25,
                  .cy = 239.5,
                  .dist = {-0.1, 0.02, 1e-3, 2e-3, 0}};
  model.scale_source = ScaleSource::kBoard;
  model.board_rms_px = 0.05;
  model.mean_reprojection_error_px = 0.25;
  for (int v = 0; v < 3; ++v) {
    View view;
    view.image = std::to_string(v) + ".jpg";
    if (v == 1) {
      view.reason = "shares 3 points with the other pictures, 15 are needed";
    } else {
      Rigid3 pose;
      pose.rotation = Eigen::AngleAxisd(0.3 * v, Eigen::Vector3d(1, 2, 3).normalized()).toRotationMatrix();
      pose.translation = Eigen::Vector3d(1.5, -2.25, 200 + v);
      view.cam_from_world = pose;
      view.mean_reprojection_error_px = 0.25;
      view.observation_count = 2;
    }
    model.views.push_back(view);
  }
  Track track;
  track.position = Eigen::Vector3d(1.25, 2.5, -3.75);
  track.colour << 200, 100, 50;
  track.observations = {{0, 7, {100.5f, 50.25f}}, {2, 9, {110.75f, 60.0f}}};
  track.mean_reprojection_error_px = 0.5;
  model.tracks.push_back(track);
  track.position = Eigen::Vector3d(4, 5, 6);
  track.observations = {{0, 3, {20.0f, 30.0f}}, {2, 1, {25.0f, 35.0f}}};
  model.tracks.push_back(track);
  return model;
}

std::uint32_t Read32(const std::string& bytes, std::size_t at) {
  std::uint32_t value = 0;
  for (int i = 3; i >= 0; --i) value = value << 8 | static_cast<unsigned char>(bytes[at + i]);
  return value;
}

std::uint32_t Read16(const std::string& bytes, std::size_t at) {
  return Read32(bytes, at) & 0xffff;
}

/// Names and contents by the central directory, each file's CRC checked.
std::map<std::string, std::string> ReadZip(const std::string& zip) {
  std::map<std::string, std::string> files;
  const std::size_t end = zip.size() - 22;
  EXPECT_EQ(Read32(zip, end), 0x06054b50u);
  std::size_t at = Read32(zip, end + 16);
  for (std::uint32_t i = 0; i < Read16(zip, end + 10); ++i) {
    EXPECT_EQ(Read32(zip, at), 0x02014b50u);
    const std::uint32_t crc = Read32(zip, at + 16), size = Read32(zip, at + 24), name_size = Read16(zip, at + 28);
    const std::string name = zip.substr(at + 46, name_size);
    const std::size_t local = Read32(zip, at + 42);
    EXPECT_EQ(Read32(zip, local), 0x04034b50u);
    files[name] = zip.substr(local + 30 + Read16(zip, local + 26), size);
    EXPECT_EQ(Crc32(files[name]), crc) << name;
    at += 46 + name_size;
  }
  return files;
}

std::vector<std::vector<std::string>> Words(const std::string& text) {
  std::vector<std::vector<std::string>> lines;
  std::istringstream in(text);
  for (std::string line; std::getline(in, line);) {
    std::istringstream words(line);
    lines.emplace_back(std::istream_iterator<std::string>(words), std::istream_iterator<std::string>());
  }
  return lines;
}

TEST(ZipWriterTest, CrcIsTheStandardOne) {
  EXPECT_EQ(Crc32("123456789"), 0xcbf43926u);
}

TEST(ZipWriterTest, EmptyArchiveIsValid) {
  const auto zip = WriteZip({});
  ASSERT_TRUE(zip.ok());
  EXPECT_TRUE(ReadZip(*zip).empty());
}

TEST(ColmapZipTest, NominalMovesPixelsByHalf) {
  const auto zip = ColmapZip(SmallModel());
  ASSERT_TRUE(zip.ok());
  const auto files = ReadZip(*zip);
  ASSERT_EQ(files.size(), 3u);
  const auto cameras = Words(files.at("cameras.txt"));
  ASSERT_EQ(cameras.size(), 1u);
  EXPECT_EQ(cameras[0], (std::vector<std::string>{"1", "OPENCV", "640", "480", "800", "810", "320.75", "240", "-0.1",
                                                  "0.02", "0.001", "0.002"}));
  const auto images = Words(files.at("images.txt"));
  ASSERT_EQ(images.size(), 4u);  // two registered views, two lines each
  EXPECT_EQ(images[0][9], "0.jpg");
  EXPECT_EQ(images[2][0], "3");
  EXPECT_EQ(images[1], (std::vector<std::string>{"101", "50.75", "1", "20.5", "30.5", "2"}));
}

TEST(ColmapZipTest, PointsAndImagesAgreeOnIndices) {
  const auto files = ReadZip(*ColmapZip(SmallModel()));
  const auto images = Words(files.at("images.txt")), points = Words(files.at("points3D.txt"));
  ASSERT_EQ(points.size(), 2u);
  for (const auto& point : points) {
    for (std::size_t k = 8; k + 1 < point.size(); k += 2) {
      const std::size_t line = point[k] == "1" ? 1 : 3;  // image ids 1 and 3
      EXPECT_EQ(images[line][3 * std::stoul(point[k + 1]) + 2], point[0]);
    }
  }
}

TEST(ColmapZipTest, ThirdRadialCoefficientNeedsTheFullModel) {
  SparseModel model = SmallModel();
  model.camera.dist[4] = 0.003;
  const auto cameras = Words(ReadZip(*ColmapZip(model)).at("cameras.txt"));
  EXPECT_EQ(cameras[0][1], "FULL_OPENCV");
  EXPECT_EQ(cameras[0].size(), 16u);
}

TEST(SparsePlyTest, NominalHoldsPositionsAndColours) {
  const std::string ply = SparsePly(SmallModel());
  const std::size_t body = ply.find("end_header\n") + 11;
  EXPECT_NE(ply.find("element vertex 2\n"), std::string::npos);
  ASSERT_EQ(ply.size() - body, 2u * 15);
  float position[3];
  std::memcpy(position, ply.data() + body, sizeof position);
  EXPECT_EQ(position[2], -3.75f);
  EXPECT_EQ(static_cast<unsigned char>(ply[body + 12]), 200);
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
