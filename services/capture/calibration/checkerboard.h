#pragma once

#include <Eigen/Core>
#include <optional>
#include <string>

#include "base/json.h"
#include "base/status.h"

namespace drupe {

/// The markers in the white squares of a ChArUco board. Ids run from 0, row by row from the top left.
struct CharucoMarkers {
  double marker_mm = 0;  ///< side of a marker, at least 0.3 and less than 0.95 of the square
  std::string dictionary = "DICT_5X5_250";
  /// The square at the top left is white when the count of rows is even, as OpenCV drew boards before 4.7; otherwise it
  /// is always black.
  bool legacy = false;
};

/// The content of pattern.json: {"pattern": "checkerboard", "inner_corners": [11, 8], "square_mm": 6.0}, or {"pattern":
/// "charuco", ..., "marker_mm": 4.5, "dictionary": "DICT_5X5_250", "legacy": false}. The corners of a ChArUco board are
/// told by the markers around them, so that it may be seen in part.
struct Checkerboard {
  int columns = 11;                                      ///< inner corners (where four squares meet) a row, 3..50
  int rows = 8;                                          ///< inner corners a column, 3..50
  double square_mm = 6;                                  ///< side of a square, 0.01..1000
  std::optional<CharucoMarkers> markers = std::nullopt;  ///< of a ChArUco board

  int CornerCount() const { return columns * rows; }
  /// Corner `index` on the pattern's plane in mm, row by row from (0, 0).
  Eigen::Vector2d CornerMm(int index) const { return {(index % columns) * square_mm, (index / columns) * square_mm}; }
  double WidthMm() const { return (columns - 1) * square_mm; }  ///< from the first inner corner to the last
  double HeightMm() const { return (rows - 1) * square_mm; }
  /// How much of a square along its edges is surely free of markers, 0..0.5.
  double ClearShare() const { return markers ? (square_mm - markers->marker_mm) / 2 / square_mm : 0.5; }
  /// Whether the square in this column (0..columns) and row (0..rows) is white.
  bool IsWhite(int column, int row) const {
    const bool starts_white = markers && markers->legacy && rows % 2 == 1;  // rows of squares are one more
    return ((column + row) % 2 == 1) != starts_white;
  }
};

/// Reads and checks pattern.json. Errors: 400 `invalid_pattern` with the field.
Result<Checkerboard> ParseCheckerboard(const Json& json);
Json ToJson(const Checkerboard& pattern);

}  // namespace drupe
