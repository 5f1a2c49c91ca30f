#pragma once

#include <string>
#include <string_view>

#include "base/status.h"
#include "scene/features.h"

namespace drupe {

/// The features of one picture as bytes, little-endian: "DRPFEAT1", the number n of keypoints (uint32), n times x, y,
/// scale_px, orientation_rad, response (float32), n times 128 descriptor values (uint8), and the SHA-256 of all that
/// (64 hexadecimal digits).
std::string WriteFeatures(const Features& features);

/// Reads what WriteFeatures wrote; believes nothing before the length and the digest agree. Errors: 422 `bad_features`
/// (another format or version, cut off, damaged, more than 4,000,000 keypoints, numbers that are not finite).
Result<Features> ReadFeatures(std::string_view bytes);

}  // namespace drupe
