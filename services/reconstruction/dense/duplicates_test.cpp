#include "reconstruction/dense/duplicates.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numeric>

namespace drupe::dense {
namespace {

constexpr float kSpacing = 0.1f;

/// Two strips of a plane, of views 0 and 1, that overlap between x = 4 and x = 6; each view likes its own side.
struct TwoStrips {
  PointCloud cloud;
  std::vector<SeamPoint> seam;

  TwoStrips() {
    for (int view = 0; view < 2; ++view) {
      const float from = view == 0 ? 0.0f : 4.03f, to = view == 0 ? 6.0f : 10.0f;
      for (float x = from; x < to; x += kSpacing) {
        for (float y = view * 0.04f; y < 3; y += kSpacing) {
          const float margin = 1 + 0.02f * (view == 0 ? 5 - x : x - 5);
          if (std::abs(x - 5) < 1.5f) {
            seam.push_back({static_cast<std::uint32_t>(cloud.size()), view, margin, kSpacing});
          }
          cloud.positions.emplace_back(x, y, 0.01f * static_cast<float>(view));
        }
      }
    }
  }
};

float NearestOf(const std::vector<Eigen::Vector3f>& points, const Eigen::Vector3f& to) {
  float nearest = 1e9f;
  for (const Eigen::Vector3f& point : points) {
    if (point != to) nearest = std::min(nearest, (point - to).norm());
  }
  return nearest;
}

std::vector<Eigen::Vector3f> Kept(const PointCloud& cloud, const std::vector<std::uint8_t>& stays) {
  std::vector<Eigen::Vector3f> kept;
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    if (stays[i]) kept.push_back(cloud.positions[i]);
  }
  return kept;
}

TEST(MarkDistinct, LeavesEveryPlaceOneSample) {
  const TwoStrips strips;
  const auto kept = Kept(strips.cloud, MarkDistinct(strips.cloud, strips.seam));
  for (const Eigen::Vector3f& point : kept) EXPECT_GE(NearestOf(kept, point), 0.74f * kSpacing) << point.transpose();
  for (float x = 0.1f; x < 9.8f; x += 0.05f) {  // no gap either
    EXPECT_LT(NearestOf(kept, {x, 1.5f, 0.0051f}), 1.3f * kSpacing) << x;
  }
  EXPECT_LT(kept.size(), strips.cloud.size() * 9 / 10);
}

TEST(MarkDistinct, PrefersTheViewThatSeesAPlaceBetter) {
  const TwoStrips strips;
  const auto stays = MarkDistinct(strips.cloud, strips.seam);
  for (const SeamPoint& point : strips.seam) {
    if (point.margin > 1.005f) {
      EXPECT_TRUE(stays[point.index]);
    }
  }
}

TEST(MarkDistinct, DoesNotDependOnTheOrder) {
  TwoStrips strips;
  const auto stays = MarkDistinct(strips.cloud, strips.seam);
  std::reverse(strips.seam.begin(), strips.seam.end());
  EXPECT_EQ(MarkDistinct(strips.cloud, strips.seam), stays);
}

TEST(MarkDistinct, KeepsAViewsOwnPoints) {
  TwoStrips strips;
  for (SeamPoint& point : strips.seam) point.owner = 0;
  const auto stays = MarkDistinct(strips.cloud, strips.seam);
  EXPECT_EQ(std::accumulate(stays.begin(), stays.end(), std::size_t{0}), strips.cloud.size());
}

}  // namespace
}  // namespace drupe::dense
