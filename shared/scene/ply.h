#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "base/status.h"
#include "scene/point_cloud.h"

namespace drupe {

/// What is accepted of a PLY file from outside.
struct PlyLimits {
  std::int64_t max_points = 50'000'000;
  std::size_t max_header_bytes = 64 << 10;
};

/// The content of dense.ply: binary little-endian, one vertex a point: float x y z, then those of float nx ny nz, uchar
/// red green blue (of the skin, without shading), uchar raw_red raw_green raw_blue (as pictured), uchar views, float
/// ncc, float expected_error that the cloud has.
std::string WritePly(const PointCloud& cloud);

/// Reads a binary little-endian PLY whose first element is `vertex` with scalar properties; float or double x y z are
/// required, the attributes that WritePly knows are optional, other properties and later elements are skipped. Errors:
/// 422 `bad_ply` (syntax, lists in a vertex, truncated, non-finite position), 415 `unsupported_ply` (ascii or
/// big-endian), 413 `ply_too_large`.
Result<PointCloud> ReadPly(std::string_view bytes, const PlyLimits& limits = {});

/// One scalar property of the vertices of such a file, such as a label; empty when the vertices do not have it. Errors
/// as ReadPly.
Result<std::vector<float>> ReadPlyScalar(std::string_view bytes, const char* property, const PlyLimits& limits = {});

}  // namespace drupe
