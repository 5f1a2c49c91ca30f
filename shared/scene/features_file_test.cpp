#include "scene/features_file.h"

#include <gtest/gtest.h>

#include <cstring>
#include <limits>

#include "base/digest.h"

namespace drupe {
namespace {

Features Sample(int count) {
  Features features;
  for (int i = 0; i < count; ++i) {
    const auto f = static_cast<float>(i);
    features.keypoints.push_back({f, 2 * f, 1.6f + f, 0.1f * f, 0.01f});
    for (int k = 0; k < Features::kDimension; ++k) features.descriptors.push_back(static_cast<std::uint8_t>(i + k));
  }
  return features;
}

/// The digest at the end made right again, as somebody who means harm would.
std::string Resealed(std::string bytes) {
  bytes.resize(bytes.size() - 64);
  return bytes + Sha256Hex(bytes);
}

TEST(FeaturesFileTest, RoundTrip) {
  for (const int count : {0, 1, 57}) {
    const Features written = Sample(count);
    const Result<Features> read = ReadFeatures(WriteFeatures(written));
    ASSERT_TRUE(read.ok()) << read.status().message();
    ASSERT_EQ(read->size(), written.size());
    EXPECT_EQ(read->descriptors, written.descriptors);
    for (std::size_t i = 0; i < written.size(); ++i) {
      EXPECT_EQ(std::memcmp(&read->keypoints[i], &written.keypoints[i], sizeof(Keypoint)), 0);
    }
  }
}

TEST(FeaturesFileTest, EveryCutIsSeen) {
  const std::string whole = WriteFeatures(Sample(2));
  for (std::size_t length = 0; length < whole.size(); ++length) {
    EXPECT_EQ(ReadFeatures(std::string_view(whole).substr(0, length)).status().code(), "bad_features") << length;
  }
  EXPECT_FALSE(ReadFeatures(whole + "x").ok());
}

TEST(FeaturesFileTest, EveryFlippedBitIsSeen) {
  const std::string whole = WriteFeatures(Sample(2));
  for (std::size_t bit = 0; bit < 8 * whole.size(); ++bit) {
    std::string damaged = whole;
    damaged[bit / 8] = static_cast<char>(damaged[bit / 8] ^ (1 << (bit % 8)));
    EXPECT_FALSE(ReadFeatures(damaged).ok()) << bit;
  }
}

TEST(FeaturesFileTest, LiesWithARightDigestAreSeen) {
  std::string many = WriteFeatures(Sample(2));
  const std::uint32_t count = 0xFFFFFFFF;
  std::memcpy(many.data() + 8, &count, sizeof(count));
  EXPECT_EQ(ReadFeatures(Resealed(many)).status().code(), "bad_features");
  Features endless = Sample(2);
  endless.keypoints[1].x = std::numeric_limits<float>::infinity();
  EXPECT_EQ(ReadFeatures(WriteFeatures(endless)).status().code(), "bad_features");
}

}  // namespace
}  // namespace drupe
