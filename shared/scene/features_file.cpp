#include "scene/features_file.h"

#include <bit>
#include <cmath>
#include <cstring>

#include "base/digest.h"

namespace drupe {
namespace {

static_assert(std::endian::native == std::endian::little, "the file is little-endian, and so is memory");
static_assert(sizeof(Keypoint) == 5 * sizeof(float), "keypoints are written as they lie in memory");

constexpr std::string_view kMagic = "DRPFEAT1";
constexpr std::size_t kHeadBytes = kMagic.size() + sizeof(std::uint32_t);
constexpr std::size_t kDigestBytes = 64;
constexpr std::size_t kFeatureBytes = sizeof(Keypoint) + Features::kDimension;
constexpr std::uint32_t kMaxCount = 4'000'000;

Status Bad(const std::string& what) {
  return Unprocessable("bad_features", "the features cannot be read: " + what);
}

/// The number of keypoints, once magic, length and digest have proved that it can be believed.
Result<std::size_t> CheckedCount(std::string_view bytes) {
  if (!bytes.starts_with(kMagic)) return Bad("not features of this version");
  if (bytes.size() < kHeadBytes + kDigestBytes) return Bad("cut off");
  std::uint32_t count = 0;
  std::memcpy(&count, bytes.data() + kMagic.size(), sizeof(count));
  if (count > kMaxCount) return Bad("more than " + std::to_string(kMaxCount) + " keypoints");
  if (bytes.size() != kHeadBytes + count * kFeatureBytes + kDigestBytes) return Bad("the length is wrong");
  const std::string_view content = bytes.substr(0, bytes.size() - kDigestBytes);
  if (Sha256Hex(content) != bytes.substr(content.size())) return Bad("damaged");
  return std::size_t{count};
}

bool IsFinite(const Keypoint& k) {
  return std::isfinite(k.x) && std::isfinite(k.y) && std::isfinite(k.scale_px) && std::isfinite(k.orientation_rad) &&
         std::isfinite(k.response);
}

}  // namespace

std::string WriteFeatures(const Features& features) {
  const auto count = static_cast<std::uint32_t>(features.size());
  std::string bytes(kMagic);
  bytes.reserve(kHeadBytes + count * kFeatureBytes + kDigestBytes);
  bytes.append(reinterpret_cast<const char*>(&count), sizeof(count));
  bytes.append(reinterpret_cast<const char*>(features.keypoints.data()), count * sizeof(Keypoint));
  bytes.append(reinterpret_cast<const char*>(features.descriptors.data()), features.descriptors.size());
  return bytes + Sha256Hex(bytes);
}

Result<Features> ReadFeatures(std::string_view bytes) {
  DRUPE_ASSIGN_OR_RETURN(const std::size_t count, CheckedCount(bytes));
  Features features;
  features.keypoints.resize(count);
  features.descriptors.resize(count * Features::kDimension);
  const char* at = bytes.data() + kHeadBytes;
  if (count > 0) std::memcpy(features.keypoints.data(), at, count * sizeof(Keypoint));
  at += count * sizeof(Keypoint);
  if (count > 0) std::memcpy(features.descriptors.data(), at, features.descriptors.size());
  for (const Keypoint& keypoint : features.keypoints) {
    if (!IsFinite(keypoint)) return Bad("a keypoint is not finite");
  }
  return features;
}

}  // namespace drupe
