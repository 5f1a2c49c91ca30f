#include <string>

#include "reconstruction/dense/dense.h"

namespace drupe {

namespace {

template <typename T>
Status CheckRange(const char* field, T value, T low, T high) {
  if (value >= low && value <= high) return Status::Ok();
  return InvalidArgument(
      "invalid_option",
      std::string(field) + " must lie between " + std::to_string(low) + " and " + std::to_string(high), field);
}

}  // namespace

Status DenseOptions::Check() const {
  DRUPE_RETURN_IF_ERROR(CheckRange("level", level, 0, 6));
  DRUPE_RETURN_IF_ERROR(CheckRange("csize", csize, 1, 16));
  DRUPE_RETURN_IF_ERROR(CheckRange("wsize", wsize, 5, 15));
  if (wsize % 2 == 0) return InvalidArgument("invalid_option", "wsize must be odd", "wsize");
  DRUPE_RETURN_IF_ERROR(CheckRange("threshold", threshold, 0.0, 1.0));
  DRUPE_RETURN_IF_ERROR(CheckRange("min_image_num", min_image_num, 2, 16));
  DRUPE_RETURN_IF_ERROR(CheckRange("parts", parts, 0, 64));
  DRUPE_RETURN_IF_ERROR(CheckRange("max_angle_deg", max_angle_deg, 1.0, 60.0));
  DRUPE_RETURN_IF_ERROR(CheckRange("min_height_mm", min_height_mm, 0.0, 1000.0));
  DRUPE_RETURN_IF_ERROR(CheckRange<std::int64_t>("max_points", max_points, 1000, 200'000'000));
  return CheckRange<std::size_t>("memory_limit_mb", memory_limit_mb, 100, 1'000'000);
}

}  // namespace drupe
