#include "reconstruction/sparse/sparse_options.h"

#include <string>

namespace drupe {
namespace {

struct Range {
  const char* field;
  double value, minimum, maximum;
};

std::string Number(double value) {
  std::string text = std::to_string(value);
  text.erase(text.find_last_not_of('0') + 1);
  if (text.back() == '.') text.pop_back();
  return text;
}

}  // namespace

Status SparseOptions::Check() const {
  const Range ranges[] = {
      {"max_reprojection_error_px", max_reprojection_error_px, 0.5, 50},
      {"min_triangulation_angle_deg", min_triangulation_angle_deg, 0.1, 30},
      {"feature_loss_px", feature_loss_px, 0.1, 50},
      {"board_loss_px", board_loss_px, 0.05, 50},
      {"min_pnp_inliers", static_cast<double>(min_pnp_inliers), 6, 10000},
      {"max_ransac_iterations", static_cast<double>(max_ransac_iterations), 50, 1000000},
      {"min_board_corners", static_cast<double>(min_board_corners), 4, 4000},
      {"min_board_views", static_cast<double>(min_board_views), 2, 400},
      {"min_registered_share", min_registered_share, 0, 1},
  };
  for (const Range& range : ranges) {
    if (range.value >= range.minimum && range.value <= range.maximum) continue;  // NaN fails both
    return InvalidArgument(
        "invalid_option",
        std::string(range.field) + " must be " + Number(range.minimum) + " to " + Number(range.maximum),
        std::string("sparse.") + range.field);
  }
  return Status::Ok();
}

}  // namespace drupe
