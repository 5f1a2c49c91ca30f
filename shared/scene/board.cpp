#include "scene/board.h"

#include <Eigen/Geometry>
#include <charconv>
#include <cmath>
#include <optional>

#include "scene/marker_dictionary.h"

namespace drupe {
namespace {

constexpr std::size_t kMaxMarkers = 1000;
constexpr double kMaxCoordinateMm = 1e5;
constexpr double kMinMarkerMm = 0.01;

Status InvalidBoard(std::string message, std::string field) {
  return InvalidArgument("invalid_board", std::move(message), std::move(field));
}

/// Only the canonical spelling ("7", not "07"), so that no two keys name one marker.
std::optional<int> ParseMarkerId(const std::string& text) {
  int id = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), id);
  if (error != std::errc() || end != text.data() + text.size() || std::to_string(id) != text) return std::nullopt;
  return id;
}

std::optional<Eigen::Vector3d> ParsePoint(const Json& json) {
  if (!json.is_array() || json.size() != 3) return std::nullopt;
  Eigen::Vector3d point;
  for (std::size_t i = 0; i < 3; ++i) {
    if (!json[i].is_number()) return std::nullopt;
    point[static_cast<Eigen::Index>(i)] = json[i].get<double>();
  }
  const bool in_range = point.allFinite() && point.cwiseAbs().maxCoeff() <= kMaxCoordinateMm;
  return in_range ? std::optional(point) : std::nullopt;
}

/// True when the corners turn clockwise, seen from above, around a convex quadrangle of some size.
bool IsClockwise(const std::array<Eigen::Vector3d, 4>& corners) {
  for (int i = 0; i < 4; ++i) {
    const Eigen::Vector3d in = corners[(i + 1) % 4] - corners[i];
    const Eigen::Vector3d out = corners[(i + 2) % 4] - corners[(i + 1) % 4];
    if (in.norm() < kMinMarkerMm || in.cross(out).z() >= 0) return false;
  }
  return true;
}

Result<std::array<Eigen::Vector3d, 4>> ParseCorners(const Json& json, const std::string& field) {
  if (!json.is_array() || json.size() != 4) return InvalidBoard("a marker needs 4 corners", field);
  std::array<Eigen::Vector3d, 4> corners;
  for (std::size_t i = 0; i < 4; ++i) {
    const auto point = ParsePoint(json[i]);
    if (!point) return InvalidBoard("a corner needs 3 finite numbers of at most 100000 mm", field);
    if (point->z() != 0) return InvalidBoard("the corners must lie on the board, at z = 0", field);
    corners[i] = *point;
  }
  if (!IsClockwise(corners)) {
    return InvalidBoard("the corners must turn clockwise from the marker's top left, seen from above", field);
  }
  return corners;
}

}  // namespace

Board MakeGridBoard(int columns, int rows, double marker_mm, double pitch_mm, const std::string& dictionary) {
  Board board{.dictionary = dictionary, .corners_mm = {}};
  for (int row = 0; row < rows; ++row) {
    for (int column = 0; column < columns; ++column) {
      const double left = (column - (columns - 1) / 2.0) * pitch_mm - marker_mm / 2;
      const double top = ((rows - 1) / 2.0 - row) * pitch_mm + marker_mm / 2;
      const double right = left + marker_mm, bottom = top - marker_mm;
      board.corners_mm[row * columns + column] = {Eigen::Vector3d(left, top, 0), Eigen::Vector3d(right, top, 0),
                                                  Eigen::Vector3d(right, bottom, 0), Eigen::Vector3d(left, bottom, 0)};
    }
  }
  return board;
}

Result<Board> ParseBoard(const Json& json) {
  if (!json.is_object()) return InvalidBoard("the board must be a JSON object", "board");
  const auto name = json.find("dictionary");
  const auto markers = json.find("corners_mm");
  if (name == json.end() || !name->is_string()) return InvalidBoard("the dictionary's name is missing", "dictionary");
  const MarkerDictionary* dictionary = FindMarkerDictionary(name->get_ref<const std::string&>());
  if (dictionary == nullptr) return InvalidBoard("there is no such dictionary of markers", "dictionary");
  if (markers == json.end() || !markers->is_object() || markers->empty() || markers->size() > kMaxMarkers) {
    return InvalidBoard("corners_mm must be an object of 1 to 1000 markers", "corners_mm");
  }
  Board board{.dictionary = std::string(dictionary->name), .corners_mm = {}};
  for (const auto& [key, value] : markers->items()) {
    const std::string field = "corners_mm." + key.substr(0, 20);
    const std::optional<int> id = ParseMarkerId(key);
    if (!id || *id < 0 || *id >= dictionary->marker_count) {
      return InvalidBoard("the dictionary's markers are 0 to " + std::to_string(dictionary->marker_count - 1), field);
    }
    DRUPE_ASSIGN_OR_RETURN(board.corners_mm[*id], ParseCorners(value, field));
  }
  return board;
}

Json ToJson(const Board& board) {
  Json markers = Json::object();
  for (const auto& [id, corners] : board.corners_mm) {
    Json& list = markers[std::to_string(id)] = Json::array();
    for (const Eigen::Vector3d& corner : corners) list.push_back({corner.x(), corner.y(), corner.z()});
  }
  return {{"dictionary", board.dictionary}, {"corners_mm", std::move(markers)}};
}

}  // namespace drupe
