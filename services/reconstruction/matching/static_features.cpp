#include "reconstruction/matching/static_features.h"

#include <algorithm>
#include <cmath>

#include "base/parallel.h"
#include "scene/descriptor_distance.h"
#include "scene/keypoint_grid.h"

namespace drupe {
namespace {

/// Fewer coincidences than this prove nothing.
constexpr int kMinCoincidences = 3;
/// The same look: |a - b|^2 of two descriptors of squared norm 512^2, and their ratio of scales.
constexpr std::int32_t kSameLook = 512 * 512 / 5;
constexpr float kSameScale = 1.3f;

bool LooksTheSame(const Features& a, std::size_t i, const Features& b, std::size_t j) {
  const float ratio = a.keypoints[i].scale_px / b.keypoints[j].scale_px;
  return ratio < kSameScale && ratio * kSameScale > 1 && SquaredDistance(a.Descriptor(i), b.Descriptor(j)) < kSameLook;
}

/// True when `other` has the feature `i` of `features` in the same place.
bool IsFoundIn(const Features& features, std::size_t i, const Features& other, const KeypointGrid& grid, float radius) {
  const Keypoint& here = features.keypoints[i];
  const Eigen::Vector2f place(here.x, here.y);
  bool found = false;
  grid.VisitBox(place.array() - radius, place.array() + radius, [&](std::uint32_t j) {
    const Keypoint& there = other.keypoints[j];
    found = found || (std::hypot(there.x - here.x, there.y - here.y) <= radius && LooksTheSame(features, i, other, j));
  });
  return found;
}

/// Another picture in which static features are looked for.
struct Compared {
  const Features* features;
  const KeypointGrid* grid;
};

/// `compared`: the nearest first.
std::vector<std::uint8_t> FindStaticAmong(const Features& picture, std::span<const Compared> compared, float radius,
                                          double min_share) {
  const std::size_t far = compared.size() / 2;  // from here on
  const auto share_of = [&](std::size_t count) { return static_cast<int>(std::ceil(min_share * count)); };
  const int required = std::max(kMinCoincidences, share_of(compared.size()));
  const int required_far = share_of(compared.size() - far);
  std::vector<std::uint8_t> is_static(picture.size(), 0);
  for (std::size_t i = 0; i < picture.size(); ++i) {
    int found = 0, found_far = 0;
    for (std::size_t k = 0; k < compared.size(); ++k) {
      if (!IsFoundIn(picture, i, *compared[k].features, *compared[k].grid, radius)) continue;
      ++found;
      found_far += k >= far ? 1 : 0;
    }
    is_static[i] = found >= required && found_far >= required_far ? 1 : 0;
  }
  return is_static;
}

KeypointGrid GridOf(const Features& picture, float radius) {
  return KeypointGrid(picture, 4 * radius);
}

}  // namespace

std::vector<std::size_t> ComparedForStatic(std::size_t image, std::size_t count) {
  const std::size_t reach = std::max(image + 1, std::min(count, kComparedForStatic));
  const std::size_t compared = std::min(kComparedForStatic, reach - 1);
  std::vector<std::size_t> others;
  for (std::size_t k = 1; k <= compared; ++k) others.push_back((image + k * reach / (compared + 1)) % reach);
  const auto distance = [image](std::size_t other) { return other > image ? other - image : image - other; };
  std::stable_sort(others.begin(), others.end(),
                   [&](std::size_t a, std::size_t b) { return distance(a) < distance(b); });
  return others;
}

std::vector<std::uint8_t> FindStaticFeatures(const Features& picture, std::span<const Features> compared,
                                             double radius_px, double min_share) {
  const auto radius = static_cast<float>(radius_px);
  std::vector<KeypointGrid> grids;
  grids.reserve(compared.size());
  std::vector<Compared> others;
  for (const Features& other : compared) {
    grids.push_back(GridOf(other, radius));
    others.push_back({&other, &grids.back()});
  }
  return FindStaticAmong(picture, others, radius, min_share);
}

Result<std::vector<std::vector<std::uint8_t>>> FindStaticFeatures(std::span<const Features> features, double radius_px,
                                                                  double min_share, const RunContext& context) {
  const auto radius = static_cast<float>(radius_px);
  std::vector<KeypointGrid> grids(features.size());
  DRUPE_RETURN_IF_ERROR(ParallelFor(context, features.size(),
                                    [&](std::size_t image) { grids[image] = GridOf(features[image], radius); }));
  std::vector<std::vector<std::uint8_t>> is_static(features.size());
  DRUPE_RETURN_IF_ERROR(ParallelFor(context, features.size(), [&](std::size_t image) {
    std::vector<Compared> others;
    for (const std::size_t other : ComparedForStatic(image, features.size())) {
      others.push_back({&features[other], &grids[other]});
    }
    is_static[image] = FindStaticAmong(features[image], others, radius, min_share);
  }));
  return is_static;
}

}  // namespace drupe
