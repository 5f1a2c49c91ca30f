#include "defect_analysis/fruit/fruit_options.h"

#include "base/option_check.h"

namespace drupe {
Status FruitOptions::Check() const {
  if (!(board_clearance_mm >= 0 && board_clearance_mm <= 50))
    return RefuseOption("fruit.board_clearance_mm", "0 to 50");
  if (!(voxel_mm >= 0.1 && voxel_mm <= 10)) return RefuseOption("fruit.voxel_mm", "0.1 to 10");
  if (!(min_diameter_mm > 0)) return RefuseOption("fruit.min_diameter_mm", "greater than 0");
  if (!(max_diameter_mm > min_diameter_mm))
    return RefuseOption("fruit.max_diameter_mm", "greater than min_diameter_mm");
  if (!(nominal_diameter_mm > 0)) return RefuseOption("fruit.nominal_diameter_mm", "greater than 0");
  if (min_points < 100) return RefuseOption("fruit.min_points", "at least 100");
  if (!(min_observed_share >= 0 && min_observed_share <= 1)) return RefuseOption("fruit.min_observed_share", "0 to 1");
  if (!(max_shape_residual > 0 && max_shape_residual <= 1)) return RefuseOption("fruit.max_shape_residual", "0 to 1");
  if (surface_degree < 2 || surface_degree > 24) return RefuseOption("fruit.surface_degree", "2 to 24");
  if (!(outlier_distance_mm > 0)) return RefuseOption("fruit.outlier_distance_mm", "greater than 0");
  if (max_fruits < 1 || max_fruits > 1000) return RefuseOption("fruit.max_fruits", "1 to 1000");
  return Status::Ok();
}

Result<FruitOptions> ParseFruitOptions(const Json& json, const std::string& path) {
  FruitOptions options;
  OptionReader reader(json, path);
  reader.Read("board_clearance_mm", options.board_clearance_mm);
  reader.Read("voxel_mm", options.voxel_mm);
  reader.Read("min_diameter_mm", options.min_diameter_mm);
  reader.Read("max_diameter_mm", options.max_diameter_mm);
  reader.Read("nominal_diameter_mm", options.nominal_diameter_mm);
  reader.Read("min_points", options.min_points);
  reader.Read("min_observed_share", options.min_observed_share);
  reader.Read("max_shape_residual", options.max_shape_residual);
  reader.Read("surface_degree", options.surface_degree);
  reader.Read("outlier_distance_mm", options.outlier_distance_mm);
  reader.Read("max_fruits", options.max_fruits);
  DRUPE_RETURN_IF_ERROR(reader.Finish());
  DRUPE_RETURN_IF_ERROR(options.Check());
  return options;
}

Json ToJson(const FruitOptions& options) {
  return {{"board_clearance_mm", options.board_clearance_mm},
          {"voxel_mm", options.voxel_mm},
          {"min_diameter_mm", options.min_diameter_mm},
          {"max_diameter_mm", options.max_diameter_mm},
          {"nominal_diameter_mm", options.nominal_diameter_mm},
          {"min_points", options.min_points},
          {"min_observed_share", options.min_observed_share},
          {"max_shape_residual", options.max_shape_residual},
          {"surface_degree", options.surface_degree},
          {"outlier_distance_mm", options.outlier_distance_mm},
          {"max_fruits", options.max_fruits}};
}

}  // namespace drupe
