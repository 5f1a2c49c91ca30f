#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <string_view>
#include <vector>

#include "base/limits.h"
#include "base/status.h"
#include "image/colour.h"
#include "scene/ply.h"
#include "scene/point_cloud.h"

namespace drupe {

/// Colours that are known to be fruit or background: what a colour model is trained from and judged by.
struct LabelledColours {
  std::vector<Rgb8> colours;
  std::vector<std::uint8_t> is_fruit;  ///< one a colour: 1 fruit, 0 background

  std::size_t size() const { return colours.size(); }
  void Add(const Rgb8& colour, bool fruit);
  void Append(const LabelledColours& other);
};

/// How far from the fruit's surface a point of a cloud is its skin for certain, and how far certainly not, mm. What
/// lies between is left out: there the colours of both mix.
struct SurfaceLabelOptions {
  double fruit_mm = 0.3;
  double background_mm = 1.0;
};

/// Labels a cloud by its distance from a surface that is known as points (a scan, or the truth of a rendered set). Both
/// in the same frame, mm.
LabelledColours LabelBySurface(const PointCloud& cloud, const std::vector<Eigen::Vector3f>& surface,
                               const SurfaceLabelOptions& options = {});

/// Reads a PLY file whose vertices have a scalar property `label` (1 fruit, 0 background; others are left out) and
/// colours. Errors: those of ReadPly; 422 `no_labels` when the file has no such property or no colours.
Result<LabelledColours> ReadLabelledPly(std::string_view bytes, const PlyLimits& limits = {});

/// Reads a picture and its mask: the same size, fruit where the mask is 128 or more. At most a million pixels are
/// taken, evenly. Errors: those of DecodeRgb; 422 `mask_size` when the sizes differ.
Result<LabelledColours> ReadMaskedImage(std::string_view image, std::string_view mask, const Limits& limits = {});

}  // namespace drupe
