#pragma once

#include <Eigen/Core>

#include "base/json.h"
#include "base/status.h"

namespace drupe {

/// The content of pattern.json: {"pattern": "checkerboard", "inner_corners": [11, 8], "square_mm": 6.0}.
struct Checkerboard {
  int columns = 11;      ///< inner corners (where four squares meet) a row, 3..50
  int rows = 8;          ///< inner corners a column, 3..50
  double square_mm = 6;  ///< side of a square, 0.01..1000

  int CornerCount() const { return columns * rows; }
  /// Corner `index` on the pattern's plane in mm, row by row from (0, 0).
  Eigen::Vector2d CornerMm(int index) const { return {(index % columns) * square_mm, (index / columns) * square_mm}; }
};

/// Reads and checks pattern.json. Errors: 400 `invalid_pattern` with the field.
Result<Checkerboard> ParseCheckerboard(const Json& json);
Json ToJson(const Checkerboard& pattern);

}  // namespace drupe
