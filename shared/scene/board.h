#pragma once

#include <Eigen/Core>
#include <array>
#include <map>
#include <string>
#include <vector>

#include "base/json.h"
#include "base/status.h"

namespace drupe {

/// The content of board.json: ArUco markers on the turntable. Frame: origin in the board's middle, z = 0 on the board, z
/// up, mm.
struct Board {
  std::string dictionary = "DICT_4X4_250";
  /// Marker id to its corners in mm, clockwise from the marker's top left as seen from above.
  std::map<int, std::array<Eigen::Vector3d, 4>> corners_mm;
};

/// The default board: columns x rows markers of `marker_mm` at a pitch of `pitch_mm`, ids row by row from the top left.
Board MakeGridBoard(int columns = 9, int rows = 9, double marker_mm = 8.0, double pitch_mm = 12.0,
                    const std::string& dictionary = "DICT_4X4_250");

/// Reads and checks board.json. Errors: 400 `invalid_board` (unknown dictionary, id outside it, not 4 corners,
/// non-finite numbers, more than 1000 markers).
Result<Board> ParseBoard(const Json& json);
Json ToJson(const Board& board);

/// A marker of the board as seen in one picture; corners in pixels, sub-pixel, in the order of Board::corners_mm.
struct MarkerDetection {
  int id = 0;
  std::array<Eigen::Vector2d, 4> corners_px;
};

/// The markers of one picture, ascending by id.
using BoardDetection = std::vector<MarkerDetection>;

}  // namespace drupe
