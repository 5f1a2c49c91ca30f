#include "capture/calibration/checkerboard.h"

#include <utility>

#include "scene/marker_dictionary.h"

namespace drupe {
namespace {

Status Invalid(std::string message, std::string field) {
  return InvalidArgument("invalid_pattern", std::move(message), std::move(field));
}

bool IsCount(const Json& json) {
  return json.is_number_integer() && json.get<std::int64_t>() >= 3 && json.get<std::int64_t>() <= 50;
}

bool IsBetween(const Json& json, double least, double most) {
  return json.is_number() && json.get<double>() >= least && json.get<double>() <= most;
}

Result<CharucoMarkers> ParseMarkers(const Json& json, const Checkerboard& pattern) {
  CharucoMarkers markers;
  const Json side = json.value("marker_mm", Json());
  if (!IsBetween(side, 0.3 * pattern.square_mm, 0.95 * pattern.square_mm)) {
    return Invalid("must be a number of millimetres, 0.3 to 0.95 of square_mm", "marker_mm");
  }
  markers.marker_mm = side.get<double>();
  const Json name = json.value("dictionary", Json(markers.dictionary));
  const MarkerDictionary* known = name.is_string() ? FindMarkerDictionary(name.get<std::string>()) : nullptr;
  if (known == nullptr) return Invalid("there is no such dictionary of markers", "dictionary");
  markers.dictionary = known->name;
  if ((pattern.columns + 1) * (pattern.rows + 1) / 2 > known->marker_count) {
    return Invalid("has fewer markers than the board has white squares", "dictionary");
  }
  const Json legacy = json.value("legacy", Json(false));
  if (!legacy.is_boolean()) return Invalid("must be true or false", "legacy");
  markers.legacy = legacy.get<bool>();
  return markers;
}

}  // namespace

Result<Checkerboard> ParseCheckerboard(const Json& json) {
  if (!json.is_object()) return Invalid("the pattern must be a JSON object", "pattern");
  const Json kind = json.value("pattern", Json());
  if (kind != "checkerboard" && kind != "charuco") return Invalid("must be \"checkerboard\" or \"charuco\"", "pattern");
  const Json counts = json.value("inner_corners", Json());
  if (!counts.is_array() || counts.size() != 2 || !IsCount(counts[0]) || !IsCount(counts[1])) {
    return Invalid("must be two whole numbers from 3 to 50: inner corners a row and a column", "inner_corners");
  }
  const Json square = json.value("square_mm", Json());
  if (!IsBetween(square, 0.01, 1000)) return Invalid("must be a number of millimetres from 0.01 to 1000", "square_mm");
  Checkerboard pattern{counts[0].get<int>(), counts[1].get<int>(), square.get<double>()};
  if (kind == "charuco") {
    DRUPE_ASSIGN_OR_RETURN(pattern.markers, ParseMarkers(json, pattern));
  }
  return pattern;
}

Json ToJson(const Checkerboard& pattern) {
  Json json = {{"pattern", pattern.markers ? "charuco" : "checkerboard"},
               {"inner_corners", Json::array({pattern.columns, pattern.rows})},
               {"square_mm", pattern.square_mm}};
  if (!pattern.markers) return json;
  json["marker_mm"] = pattern.markers->marker_mm;
  json["dictionary"] = pattern.markers->dictionary;
  json["legacy"] = pattern.markers->legacy;
  return json;
}

}  // namespace drupe
