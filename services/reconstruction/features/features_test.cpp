#include "reconstruction/features/features.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>
#include <set>
#include <tuple>
#include <vector>

namespace drupe {
namespace {

/// Blobs of many sizes, brightnesses and places on grey, the same for the same seed: a scene whose picture can be drawn
/// under any similarity transform exactly.
struct BlobScene {
  struct Blob {
    double x, y, sigma, height;
  };
  std::vector<Blob> blobs;

  BlobScene(int count, double side, std::uint64_t seed) {
    std::mt19937_64 random(seed);
    const auto uniform = [&random](double low, double high) {
      return low + (high - low) * static_cast<double>(random() >> 11) * 0x1p-53;
    };
    for (int i = 0; i < count; ++i) {
      blobs.push_back({uniform(-side, side), uniform(-side, side), uniform(1.5, 5), uniform(-60, 60)});
    }
  }

  /// The scene turned by `angle`, scaled, about the picture's centre.
  GrayImage Draw(int width, int height, double angle, double scale) const {
    std::vector<double> sum(static_cast<std::size_t>(width) * height, 128.0);
    for (const Blob& blob : blobs) {
      const double x = width / 2.0 + scale * (blob.x * std::cos(angle) - blob.y * std::sin(angle));
      const double y = height / 2.0 + scale * (blob.x * std::sin(angle) + blob.y * std::cos(angle));
      const double sigma = scale * blob.sigma;
      const int reach = static_cast<int>(4 * sigma) + 1;
      for (int v = std::max(0, static_cast<int>(y) - reach); v < std::min(height, static_cast<int>(y) + reach); ++v) {
        for (int u = std::max(0, static_cast<int>(x) - reach); u < std::min(width, static_cast<int>(x) + reach); ++u) {
          const double squared = (u - x) * (u - x) + (v - y) * (v - y);
          sum[static_cast<std::size_t>(v) * width + u] += blob.height * std::exp(-squared / (2 * sigma * sigma));
        }
      }
    }
    GrayImage image(width, height);
    for (int v = 0; v < height; ++v) {
      for (int u = 0; u < width; ++u) {
        image.At(u, v) =
            static_cast<std::uint8_t>(std::clamp(std::round(sum[static_cast<std::size_t>(v) * width + u]), 0.0, 255.0));
      }
    }
    return image;
  }
};

FeatureOptions FromOctave(int first_octave) {
  FeatureOptions options;
  options.first_octave = first_octave;
  options.peak_threshold = 0.01;
  return options;
}

Features Find(const GrayImage& image, const FeatureOptions& options) {
  Result<Features> features = RunFeatures(image, options, RunContext());
  EXPECT_TRUE(features.ok());
  return features.ok() ? std::move(features).value() : Features();
}

double CosineOf(const Features& a, std::size_t i, const Features& b, std::size_t j) {
  double ab = 0, aa = 0, bb = 0;
  for (int k = 0; k < Features::kDimension; ++k) {
    const double x = a.Descriptor(i)[k], y = b.Descriptor(j)[k];
    ab += x * y;
    aa += x * x;
    bb += y * y;
  }
  return ab / std::sqrt(aa * bb);
}

TEST(FeaturesTest, FindsABlobWithItsPlaceAndScale) {
  BlobScene scene(0, 1, 1);
  scene.blobs.push_back({3.3, -7.6, 6.0, 80.0});
  const Features features = Find(scene.Draw(160, 120, 0, 1), FromOctave(0));
  ASSERT_FALSE(features.keypoints.empty());
  EXPECT_NEAR(features.keypoints[0].x, 83.3, 0.05);
  EXPECT_NEAR(features.keypoints[0].y, 52.4, 0.05);
  // A Gaussian blob of variance s^2 answers most at a scale near s.
  EXPECT_NEAR(features.keypoints[0].scale_px, 6.0, 1.2);
}

TEST(FeaturesTest, OctavesAgreeOnThePlace) {
  BlobScene scene(0, 1, 1);
  scene.blobs.push_back({-4.25, 9.4, 7.0, -70.0});
  const GrayImage image = scene.Draw(200, 200, 0, 1);
  for (const int octave : {-1, 0, 1}) {
    const Features features = Find(image, FromOctave(octave));
    ASSERT_FALSE(features.keypoints.empty()) << "octave " << octave;
    EXPECT_NEAR(features.keypoints[0].x, 95.75, 0.1) << "octave " << octave;
    EXPECT_NEAR(features.keypoints[0].y, 109.4, 0.1) << "octave " << octave;
  }
}

TEST(FeaturesTest, DescriptorsSurviveTurnAndScale) {
  const BlobScene scene(500, 110, 7);
  constexpr double kAngle = 0.6, kScale = 1.25;
  const Features before = Find(scene.Draw(320, 320, 0, 1), FromOctave(0));
  const Features after = Find(scene.Draw(400, 400, kAngle, kScale), FromOctave(0));
  ASSERT_GT(before.size(), 150u);
  int right = 0, tried = 0;
  for (std::size_t i = 0; i < before.size(); ++i) {
    const double dx = before.keypoints[i].x - 160, dy = before.keypoints[i].y - 160;
    if (std::hypot(dx, dy) > 120) continue;
    const double x = 200 + kScale * (dx * std::cos(kAngle) - dy * std::sin(kAngle));
    const double y = 200 + kScale * (dx * std::sin(kAngle) + dy * std::cos(kAngle));
    std::size_t best = 0;
    for (std::size_t j = 1; j < after.size(); ++j) {
      if (CosineOf(before, i, after, j) > CosineOf(before, i, after, best)) best = j;
    }
    ++tried;
    right += std::hypot(after.keypoints[best].x - x, after.keypoints[best].y - y) < 2 ? 1 : 0;
  }
  EXPECT_GT(right, 0.75 * tried) << right << " of " << tried;
}

TEST(FeaturesTest, OrientationTurnsWithThePicture) {
  const BlobScene scene(400, 110, 13);
  constexpr double kAngle = 0.9;
  const Features straight = Find(scene.Draw(320, 320, 0, 1), FromOctave(0));
  const Features turned = Find(scene.Draw(320, 320, kAngle, 1), FromOctave(0));
  int same_place = 0, same_direction = 0;
  for (const Keypoint& before : straight.keypoints) {
    const double dx = before.x - 160, dy = before.y - 160;
    const double x = 160 + dx * std::cos(kAngle) - dy * std::sin(kAngle);
    const double y = 160 + dx * std::sin(kAngle) + dy * std::cos(kAngle);
    double nearest = 10;
    for (const Keypoint& after : turned.keypoints) {
      if (std::hypot(after.x - x, after.y - y) > 0.5 || std::abs(after.scale_px / before.scale_px - 1) > 0.1) continue;
      const double difference = after.orientation_rad - before.orientation_rad - kAngle;
      nearest = std::min(nearest, std::abs(std::remainder(difference, 2 * std::numbers::pi)));
    }
    same_place += nearest < 10 ? 1 : 0;
    same_direction += nearest < 0.1 ? 1 : 0;
  }
  ASSERT_GT(same_place, 100);
  EXPECT_GT(same_direction, 0.85 * same_place) << same_direction << " of " << same_place;
}

TEST(FeaturesTest, DescriptorsAreRootSift) {
  const Features features = Find(BlobScene(200, 100, 3).Draw(240, 240, 0, 1), FromOctave(0));
  ASSERT_GT(features.size(), 20u);
  ASSERT_EQ(features.descriptors.size(), features.size() * Features::kDimension);
  for (std::size_t i = 0; i < features.size(); ++i) {
    double squares = 0;
    for (int k = 0; k < Features::kDimension; ++k) squares += std::pow(features.Descriptor(i)[k], 2);
    EXPECT_NEAR(std::sqrt(squares), 512, 16);
  }
}

TEST(FeaturesTest, BudgetIsSpreadOverThePicture) {
  // Strong texture on the left, the same ten times weaker on the right.
  GrayImage image = BlobScene(900, 256, 5).Draw(512, 256, 0, 1);
  for (int y = 0; y < image.height(); ++y) {
    for (int x = 256; x < 512; ++x) image.At(x, y) = static_cast<std::uint8_t>(128 + (image.At(x, y) - 128) / 8);
  }
  FeatureOptions options = FromOctave(0);
  options.peak_threshold = 0.003;
  options.max_features = 100;
  options.grid_cell_px = 64;
  const Features features = Find(image, options);
  std::set<std::tuple<float, float, float>> places;
  int right = 0;
  for (const Keypoint& keypoint : features.keypoints) {
    if (places.emplace(keypoint.x, keypoint.y, keypoint.scale_px).second && keypoint.x > 256) ++right;
  }
  EXPECT_LE(places.size(), 100u);
  EXPECT_GT(places.size(), 60u);
  EXPECT_GT(right, 30);
}

TEST(FeaturesTest, MaskedPlacesAreLeftOut) {
  const GrayImage image = BlobScene(400, 128, 9).Draw(256, 256, 0, 1);
  GrayImage mask(256, 256);
  for (int y = 0; y < 256; ++y) {
    for (int x = 0; x < 256; ++x) mask.At(x, y) = x < 128 ? 255 : 0;
  }
  const Result<Features> features = RunFeatures(image, FromOctave(0), RunContext(), &mask);
  ASSERT_TRUE(features.ok());
  ASSERT_GT(features->size(), 20u);
  for (const Keypoint& keypoint : features->keypoints) EXPECT_LT(keypoint.x, 128);
}

TEST(FeaturesTest, SameResultEveryTime) {
  const GrayImage image = BlobScene(300, 150, 11).Draw(300, 200, 0, 1);
  const Features a = Find(image, FeatureOptions()), b = Find(image, FeatureOptions());
  ASSERT_GT(a.size(), 0u);
  EXPECT_EQ(a.descriptors, b.descriptors);
}

TEST(FeaturesTest, FlatPictureHasNone) {
  GrayImage image(64, 48);
  for (int y = 0; y < 48; ++y) std::fill_n(image.Row(y), 64, std::uint8_t{77});
  EXPECT_EQ(Find(image, FeatureOptions()).size(), 0u);
}

TEST(FeaturesTest, RefusesBadInput) {
  const GrayImage small(15, 400), image(64, 64), mask(64, 63);
  EXPECT_EQ(RunFeatures(small, {}, {}).status().code(), "image_too_small");
  EXPECT_EQ(RunFeatures(image, {}, {}, &mask).status().code(), "invalid_mask");
  FeatureOptions options;
  options.scales_per_octave = 0;
  EXPECT_EQ(RunFeatures(image, options, {}).status().field(), "scales_per_octave");
  RunContext cancelled;
  cancelled.cancelled = [] { return true; };
  EXPECT_EQ(RunFeatures(image, {}, cancelled).status().kind(), StatusKind::kCancelled);
}

}  // namespace
}  // namespace drupe
