#pragma once

#include <Eigen/Core>
#include <array>
#include <string>
#include <vector>

#include "base/json.h"
#include "base/status.h"

namespace drupe {

/// Where on the sensor corners of the pattern were measured, in a grid of cells of equal size.
struct CoverageMap {
  static constexpr int kColumns = 8, kRows = 6;
  int width = 0, height = 0;                               ///< of the pictures
  std::array<std::array<int, kColumns>, kRows> corners{};  ///< in each cell
  std::vector<Eigen::Vector2d> pixels;                     ///< all of them

  CoverageMap() = default;
  CoverageMap(int picture_width, int picture_height) : width(picture_width), height(picture_height) {}
  void Add(const std::vector<Eigen::Vector2d>& measured);
  /// Share of the cells with corners, 0..1.
  double Share() const;
  /// The parts of the picture, of nine, of which less than half showed corners: "top left", "top", ..., "middle".
  std::vector<std::string> WeakParts() const;
  /// The same for people: "top left, top"; "none".
  std::string WeakText() const;
};

/// {"grid": [8, 6], "corners": [[...] a row], "weak_parts": [...]}
Json ToJson(const CoverageMap& map);

/// The map as a picture of the sensor, 8-bit colour PNG, 960 pixels wide: the greener a cell the more corners, red
/// where there are none, a dot a corner, and in words what is missing. Errors: 500 `drawing_failed`.
Result<std::string> DrawCoverage(const CoverageMap& map);

}  // namespace drupe
