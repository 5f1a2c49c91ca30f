#include "cli/image_directory.h"

#include <gtest/gtest.h>

#include <fstream>
#include <string>

#include "base/ids.h"

namespace drupe {
namespace {

/// A directory that is removed with everything in it.
class ImageDirectory : public ::testing::Test {
 protected:
  void SetUp() override { std::filesystem::create_directory(path_); }
  void TearDown() override { std::filesystem::remove_all(path_); }
  void Touch(const std::string& name) { std::ofstream(path_ / name) << "x"; }

  const std::filesystem::path path_ = std::filesystem::temp_directory_path() / NewId("test");
};

TEST_F(ImageDirectory, ListsPicturesByNameAndNothingElse) {
  for (const char* name : {"10.jpg", "02.JPG", "01.png", "03.tiff", "notes.txt", "calibration.json"}) Touch(name);
  std::filesystem::create_directory(path_ / "04.jpg");
  const auto images = ListImages(path_, {});
  ASSERT_TRUE(images.ok()) << images.status().ToString();
  std::vector<std::string> names;
  for (const auto& image : *images) names.push_back(image.filename().string());
  EXPECT_EQ(names, (std::vector<std::string>{"01.png", "02.JPG", "03.tiff", "10.jpg"}));
}

TEST_F(ImageDirectory, TooFewTooManyAndNoneAreTold) {
  Touch("1.jpg");
  Touch("2.jpg");
  EXPECT_EQ(ListImages(path_, {}).status().code(), "too_few_images");
  Touch("3.jpg");
  EXPECT_TRUE(ListImages(path_, {}).ok());
  Limits limits;
  limits.max_images = 2;
  EXPECT_EQ(ListImages(path_, limits).status().code(), "too_many_images");
  EXPECT_EQ(ListImages(path_ / "missing", {}).status().code(), "directory_not_found");
}

}  // namespace
}  // namespace drupe
