#include "defect_analysis/models/labelled_colours.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <unordered_map>

#include "image/decode.h"

namespace drupe {
namespace {

constexpr double kMaxPixels = 1e6;
constexpr std::uint8_t kMaskFrom = 128;

// Points of a surface in cubic cells, so that the nearest within one edge is found in 27 of them.
class SurfaceGrid {
 public:
  SurfaceGrid(const std::vector<Eigen::Vector3f>& points, double edge)
      : points_(points), inverse_edge_(static_cast<float>(1 / edge)) {
    for (std::size_t i = 0; i < points.size(); ++i) {
      cells_[Key(CellOf(points[i]))].push_back(static_cast<std::uint32_t>(i));
    }
  }

  // Squared distance to the nearest point; infinite when none is in the cells around.
  float SquaredDistance(const Eigen::Vector3f& x) const {
    const Eigen::Vector3i cell = CellOf(x);
    float nearest = std::numeric_limits<float>::infinity();
    for (int k = 0; k < 27; ++k) {
      const auto found = cells_.find(Key(cell + Eigen::Vector3i(k % 3 - 1, k / 3 % 3 - 1, k / 9 - 1)));
      if (found == cells_.end()) continue;
      for (const std::uint32_t i : found->second) nearest = std::min(nearest, (points_[i] - x).squaredNorm());
    }
    return nearest;
  }

 private:
  Eigen::Vector3i CellOf(const Eigen::Vector3f& x) const {
    return (x * inverse_edge_).array().floor().max(-1e6f).min(1e6f).cast<int>();
  }
  static std::uint64_t Key(const Eigen::Vector3i& cell) {
    std::uint64_t key = 0;
    for (int axis = 0; axis < 3; ++axis) key = key << 21 | static_cast<std::uint32_t>(cell[axis] + (1 << 20));
    return key;
  }

  const std::vector<Eigen::Vector3f>& points_;
  float inverse_edge_;
  std::unordered_map<std::uint64_t, std::vector<std::uint32_t>> cells_;
};

}  // namespace

void LabelledColours::Add(const Rgb8& colour, bool fruit) {
  colours.push_back(colour);
  is_fruit.push_back(fruit ? 1 : 0);
}

void LabelledColours::Append(const LabelledColours& other) {
  colours.insert(colours.end(), other.colours.begin(), other.colours.end());
  is_fruit.insert(is_fruit.end(), other.is_fruit.begin(), other.is_fruit.end());
}

LabelledColours LabelBySurface(const PointCloud& cloud, const std::vector<Eigen::Vector3f>& surface,
                               const SurfaceLabelOptions& options) {
  const SurfaceGrid grid(surface, options.background_mm);
  LabelledColours labelled;
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    const double distance = std::sqrt(grid.SquaredDistance(cloud.positions[i]));
    if (distance <= options.fruit_mm) labelled.Add(cloud.colours[i], true);
    if (distance >= options.background_mm) labelled.Add(cloud.colours[i], false);
  }
  return labelled;
}

Result<LabelledColours> ReadLabelledPly(std::string_view bytes, const PlyLimits& limits) {
  DRUPE_ASSIGN_OR_RETURN(const PointCloud cloud, ReadPly(bytes, limits));
  DRUPE_ASSIGN_OR_RETURN(const std::vector<float> labels, ReadPlyScalar(bytes, "label", limits));
  if (cloud.empty() || labels.empty() || cloud.colours.empty()) {
    return Unprocessable("no_labels", "the cloud's vertices need red, green, blue and label (1 fruit, 0 background)");
  }
  LabelledColours labelled;
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    if (labels[i] == 0 || labels[i] == 1) labelled.Add(cloud.colours[i], labels[i] == 1);
  }
  return labelled;
}

Result<LabelledColours> ReadMaskedImage(std::string_view image_bytes, std::string_view mask_bytes,
                                        const Limits& limits) {
  DRUPE_ASSIGN_OR_RETURN(const RgbImage image, DecodeRgb(image_bytes, limits));
  DRUPE_ASSIGN_OR_RETURN(const GrayImage mask, DecodeGray(mask_bytes, limits));
  if (image.width() != mask.width() || image.height() != mask.height()) {
    return Unprocessable("mask_size", "a mask must have as many pixels as its image");
  }
  const double pixels = static_cast<double>(image.width()) * image.height();
  const int step = std::max(1, static_cast<int>(std::ceil(std::sqrt(pixels / kMaxPixels))));
  LabelledColours labelled;
  for (int y = 0; y < image.height(); y += step) {
    for (int x = 0; x < image.width(); x += step) {
      const std::uint8_t* rgb = image.Row(y) + 3 * x;
      labelled.Add({rgb[0], rgb[1], rgb[2]}, mask.At(x, y) >= kMaskFrom);
    }
  }
  return labelled;
}

}  // namespace drupe
