#pragma once

#include "base/json.h"
#include "base/option_reader.h"
#include "base/status.h"

namespace drupe {

/// Background removal and traits (paper 4.1). Lengths in mm; without a metric scale they apply after every fruit has
/// been scaled to `nominal_diameter_mm`.
struct FruitOptions {
  double board_clearance_mm = 3.0;    ///< what lies lower than this above the board is board; 0..50
  double voxel_mm = 0.8;              ///< edge of the voxels whose connected components are the objects; 0.1..10
  double min_diameter_mm = 8.0;       ///< smaller objects are no fruit
  double max_diameter_mm = 150.0;     ///< larger objects are no fruit
  double nominal_diameter_mm = 36.0;  ///< assumed mean diameter where the scale is unknown
  int min_points = 400;               ///< objects with fewer points are no fruit
  double min_observed_share = 0.35;   ///< share of all directions about the centre that must be seen; 0..1
  double max_shape_residual = 0.03;   ///< robust residual of the closed surface, relative to its radius
  int surface_degree = 14;            ///< highest degree of the spherical harmonics of the closed surface; 2..24
  double outlier_distance_mm = 0.6;   ///< points farther than this from the closed surface are not skin
  int max_fruits = 64;                ///< reported at most, largest first

  Status Check() const;
};

/// Reads the keys of FruitOptions. Errors as OptionReader::Finish and FruitOptions::Check.
Result<FruitOptions> ParseFruitOptions(const Json& json, const std::string& path);
Json ToJson(const FruitOptions& options);

}  // namespace drupe
