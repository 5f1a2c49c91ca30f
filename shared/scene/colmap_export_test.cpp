#include "scene/colmap_export.h"

#include <gtest/gtest.h>

#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <map>

#include "base/files.h"
#include "base/ids.h"
#include "scene/small_model.h"
#include "scene/words.h"
#include "scene/zip_writer.h"

namespace drupe {
namespace {

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
  ASSERT_EQ(files.size(), 6u);
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

/// Reads COLMAP's binary files number by number.
class ByteReader {
 public:
  explicit ByteReader(std::string bytes) : bytes_(std::move(bytes)) {}

  template <typename Number>
  Number Next() {
    Number value{};
    EXPECT_LE(at_ + sizeof(value), bytes_.size());
    if (at_ + sizeof(value) <= bytes_.size()) std::memcpy(&value, bytes_.data() + at_, sizeof(value));
    at_ += sizeof(value);
    return value;
  }
  std::string NextName() {
    const std::string name = bytes_.c_str() + at_;
    at_ += name.size() + 1;
    return name;
  }
  bool IsAtEnd() const { return at_ == bytes_.size(); }

 private:
  std::string bytes_;
  std::size_t at_ = 0;
};

TEST(ColmapBinaryTest, CameraIsThatOfTheText) {
  const auto files = ReadZip(*ColmapZip(SmallModel()));
  const auto text = Words(files.at("cameras.txt"));
  ByteReader cameras(files.at("cameras.bin"));
  EXPECT_EQ(cameras.Next<std::uint64_t>(), 1u);
  EXPECT_EQ(cameras.Next<std::uint32_t>(), 1u);
  EXPECT_EQ(cameras.Next<std::int32_t>(), 4);  // OPENCV
  EXPECT_EQ(cameras.Next<std::uint64_t>(), 640u);
  EXPECT_EQ(cameras.Next<std::uint64_t>(), 480u);
  for (std::size_t i = 4; i < text[0].size(); ++i) EXPECT_EQ(cameras.Next<double>(), std::stod(text[0][i]));
  EXPECT_TRUE(cameras.IsAtEnd());
}

TEST(ColmapBinaryTest, ImagesAreThoseOfTheText) {
  const auto files = ReadZip(*ColmapZip(SmallModel()));
  const auto text = Words(files.at("images.txt"));
  ByteReader images(files.at("images.bin"));
  ASSERT_EQ(images.Next<std::uint64_t>(), 2u);
  for (std::size_t i = 0; i < 2; ++i) {
    const auto &head = text[2 * i], &points = text[2 * i + 1];
    EXPECT_EQ(std::to_string(images.Next<std::uint32_t>()), head[0]);
    for (int k = 1; k <= 7; ++k) EXPECT_EQ(images.Next<double>(), std::stod(head[k]));
    EXPECT_EQ(images.Next<std::uint32_t>(), 1u);
    EXPECT_EQ(images.NextName(), head[9]);
    ASSERT_EQ(images.Next<std::uint64_t>(), points.size() / 3);
    for (std::size_t k = 0; k < points.size(); k += 3) {
      EXPECT_EQ(images.Next<double>(), std::stod(points[k]));
      EXPECT_EQ(images.Next<double>(), std::stod(points[k + 1]));
      EXPECT_EQ(std::to_string(images.Next<std::uint64_t>()), points[k + 2]);
    }
  }
  EXPECT_TRUE(images.IsAtEnd());
}

TEST(ColmapBinaryTest, PointsAreThoseOfTheText) {
  const auto files = ReadZip(*ColmapZip(SmallModel()));
  const auto text = Words(files.at("points3D.txt"));
  ByteReader points(files.at("points3D.bin"));
  ASSERT_EQ(points.Next<std::uint64_t>(), text.size());
  for (const auto& line : text) {
    EXPECT_EQ(std::to_string(points.Next<std::uint64_t>()), line[0]);
    for (int k = 1; k <= 3; ++k) EXPECT_EQ(points.Next<double>(), std::stod(line[k]));
    for (int k = 4; k <= 6; ++k) EXPECT_EQ(std::to_string(points.Next<std::uint8_t>()), line[k]);
    EXPECT_EQ(points.Next<double>(), std::stod(line[7]));
    ASSERT_EQ(points.Next<std::uint64_t>(), (line.size() - 8) / 2);
    for (std::size_t k = 8; k < line.size(); ++k) EXPECT_EQ(std::to_string(points.Next<std::uint32_t>()), line[k]);
  }
  EXPECT_TRUE(points.IsAtEnd());
}

/// What COLMAP's own program says about a model that holds the files whose names end in `extension`; empty when it
/// refuses it.
std::string AnalyseWithColmap(const std::map<std::string, std::string>& files, const std::string& extension) {
  const auto directory = std::filesystem::temp_directory_path() / NewId("colmap");
  std::filesystem::create_directories(directory);
  for (const auto& [name, content] : files) {
    if (!name.ends_with(extension)) continue;
    EXPECT_TRUE(WriteFileAtomically(directory / name, content).ok());
  }
  const auto log = directory / "log";
  const std::string command =
      "QT_QPA_PLATFORM=offscreen colmap model_analyzer --path " + directory.string() + " > " + log.string() + " 2>&1";
  const bool succeeded = std::system(command.c_str()) == 0;
  const std::string said = ReadFile(log).value();
  std::filesystem::remove_all(directory);
  return succeeded ? said : "";
}

TEST(ColmapBinaryTest, ColmapItselfOpensBothForms) {
  if (std::system("command -v colmap > /dev/null 2>&1") != 0) GTEST_SKIP() << "colmap is not installed";
  const auto files = ReadZip(*ColmapZip(SmallModel()));
  for (const std::string extension : {".bin", ".txt"}) {
    const std::string said = AnalyseWithColmap(files, extension);
    EXPECT_NE(said.find("Registered images: 2"), std::string::npos) << extension << ": " << said;
    EXPECT_NE(said.find("Points: 2"), std::string::npos) << extension << ": " << said;
    EXPECT_NE(said.find("Observations: 4"), std::string::npos) << extension << ": " << said;
  }
}

}  // namespace
}  // namespace drupe
