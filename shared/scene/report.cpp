#include "scene/report.h"

#include <cmath>
#include <iterator>
#include <string_view>

#include "base/version.h"

namespace drupe {
namespace {

// Digits beyond these are noise, and the reader has to pass over them.
constexpr int kLengthDigits = 4;  // 0.1 micrometres
constexpr int kRatioDigits = 4;
constexpr int kColourDigits = 2;

// How what no picture shows, the underside above all, became part of volume and surface.
constexpr char kClosedBy[] = "mirror image of the opposite side about the equator, joined with least bending";

Json Rounded(double value, int digits) {
  if (!std::isfinite(value)) return nullptr;
  const double unit = std::pow(10.0, digits);
  const double rounded = std::round(value * unit) / unit;
  return rounded == 0 ? 0.0 : rounded;  // no "-0.0"
}

Json VectorJson(const Eigen::Vector3d& v, int digits) {
  return Json::array({Rounded(v.x(), digits), Rounded(v.y(), digits), Rounded(v.z(), digits)});
}

// Writes what is measured in mm, or null without a metric scale.
class MetricWriter {
 public:
  explicit MetricWriter(bool metric) : metric_(metric) {}
  Json operator()(double value) const { return metric_ ? Rounded(value, kLengthDigits) : Json(nullptr); }
  Json operator()(const Eigen::Vector3d& v) const { return metric_ ? VectorJson(v, kLengthDigits) : Json(nullptr); }
  Json operator()(const std::vector<Eigen::Vector3d>& points) const {
    if (!metric_) return nullptr;
    Json list = Json::array();
    for (const Eigen::Vector3d& p : points) list.push_back(VectorJson(p, kLengthDigits));
    return list;
  }

 private:
  bool metric_;
};

Json PlaneJson(const DefectPlane& plane, const MetricWriter& mm) {
  return {{"normal", VectorJson(plane.normal, 6)},
          {"offset_mm", mm(plane.offset_mm)},
          {"rms_mm", mm(plane.rms_mm)},
          {"mean_abs_z_mm", mm(plane.mean_abs_z_mm)}};
}

Json DefectJson(const Defect& defect, const MetricWriter& mm) {
  return {{"id", defect.id},
          {"class", DefectClassName(defect.defect_class)},
          {"confidence", Rounded(defect.confidence, kRatioDigits)},
          {"centre_mm", mm(defect.centre_mm)},
          {"normal", VectorJson(defect.normal, 6)},
          {"area_mm2", mm(defect.area_mm2)},
          {"area_uncertainty_mm2", mm(defect.area_uncertainty_mm2)},
          {"planar_area_mm2", mm(defect.planar_area_mm2)},
          {"diameter_mm", mm(defect.diameter_mm)},
          {"diameter_uncertainty_mm", mm(defect.diameter_uncertainty_mm)},
          {"area_share_pct", Rounded(defect.area_share_pct, kRatioDigits)},
          {"perimeter_mm", mm(defect.perimeter_mm)},
          {"perimeter_uncertainty_mm", mm(defect.perimeter_uncertainty_mm)},
          {"roundness", Rounded(defect.roundness, kRatioDigits)},
          {"length_mm", mm(defect.length_mm)},
          {"width_mm", mm(defect.width_mm)},
          {"depth_mm", mm(defect.depth_mm)},
          {"depth_uncertainty_mm", mm(defect.depth_uncertainty_mm)},
          {"completed", defect.completed},
          {"plane", PlaneJson(defect.plane, mm)},
          {"contour_mm", mm(defect.contour_mm)},
          {"mean_lab", VectorJson(defect.mean_lab, kColourDigits)},
          {"lab_change", VectorJson(defect.lab_change, kColourDigits)},
          {"points", defect.points}};
}

Json FruitJson(const Fruit& fruit, const MetricWriter& mm) {
  Json json = {
      {"id", fruit.id},
      {"grade", DefectClassName(fruit.grade)},
      {"centre_mm", mm(fruit.centre_mm)},
      {"volume_mm3", mm(fruit.volume_mm3)},
      {"volume_uncertainty_mm3", mm(fruit.volume_uncertainty_mm3)},
      {"surface_area_mm2", mm(fruit.surface_area_mm2)},
      {"surface_area_uncertainty_mm2", mm(fruit.surface_area_uncertainty_mm2)},
      {"diameter_mm", {{"equatorial", mm(fruit.equatorial_diameter_mm)}, {"polar", mm(fruit.polar_diameter_mm)}}},
      {"diameter_uncertainty_mm",
       {{"equatorial", mm(fruit.equatorial_uncertainty_mm)}, {"polar", mm(fruit.polar_uncertainty_mm)}}},
      {"sphericity", Rounded(fruit.sphericity, kRatioDigits)},
      {"mean_lab", VectorJson(fruit.mean_lab, kColourDigits)},
      {"lab_spread", VectorJson(fruit.lab_spread, kColourDigits)},
      {"observed_surface_pct", Rounded(fruit.observed_surface_pct, 2)},
      {"unseen_surface", {{"share_pct", Rounded(100 - fruit.observed_surface_pct, 2)}, {"closed_by", kClosedBy}}},
      {"defect_area_pct", Rounded(fruit.defect_area_pct, kRatioDigits)}};
  json["defects"] = Json::array();
  for (const Defect& defect : fruit.defects) json["defects"].push_back(DefectJson(defect, mm));
  return json;
}

Json ProvenanceJson(const Provenance& provenance) {
  return {{"image_set", provenance.image_set},
          {"image_sha256", provenance.image_sha256},
          {"calibration", provenance.calibration},
          {"options", provenance.options},
          {"build", provenance.build}};
}

// A column of the CSV: its heading, and where its value lies in the JSON of a fruit or defect.
struct Column {
  const char* heading;
  const char* key;
  std::string_view inner = {};  // of an object, or the place in an array
};

constexpr Column kFruitColumns[] = {{"fruit", "id"},
                                    {"grade", "grade"},
                                    {"volume_mm3", "volume_mm3"},
                                    {"volume_uncertainty_mm3", "volume_uncertainty_mm3"},
                                    {"surface_area_mm2", "surface_area_mm2"},
                                    {"surface_area_uncertainty_mm2", "surface_area_uncertainty_mm2"},
                                    {"equatorial_diameter_mm", "diameter_mm", "equatorial"},
                                    {"equatorial_diameter_uncertainty_mm", "diameter_uncertainty_mm", "equatorial"},
                                    {"polar_diameter_mm", "diameter_mm", "polar"},
                                    {"polar_diameter_uncertainty_mm", "diameter_uncertainty_mm", "polar"},
                                    {"sphericity", "sphericity"},
                                    {"observed_surface_pct", "observed_surface_pct"},
                                    {"defect_area_pct", "defect_area_pct"}};

constexpr Column kDefectColumns[] = {{"defect", "id"},
                                     {"class", "class"},
                                     {"confidence", "confidence"},
                                     {"area_mm2", "area_mm2"},
                                     {"area_uncertainty_mm2", "area_uncertainty_mm2"},
                                     {"planar_area_mm2", "planar_area_mm2"},
                                     {"area_share_pct", "area_share_pct"},
                                     {"defect_diameter_mm", "diameter_mm"},
                                     {"defect_diameter_uncertainty_mm", "diameter_uncertainty_mm"},
                                     {"perimeter_mm", "perimeter_mm"},
                                     {"perimeter_uncertainty_mm", "perimeter_uncertainty_mm"},
                                     {"roundness", "roundness"},
                                     {"length_mm", "length_mm"},
                                     {"width_mm", "width_mm"},
                                     {"depth_mm", "depth_mm"},
                                     {"depth_uncertainty_mm", "depth_uncertainty_mm"},
                                     {"completed", "completed"},
                                     {"centre_x_mm", "centre_mm", "0"},
                                     {"centre_y_mm", "centre_mm", "1"},
                                     {"centre_z_mm", "centre_mm", "2"},
                                     {"mean_l", "mean_lab", "0"},
                                     {"mean_a", "mean_lab", "1"},
                                     {"mean_b", "mean_lab", "2"},
                                     {"change_l", "lab_change", "0"},
                                     {"change_a", "lab_change", "1"},
                                     {"change_b", "lab_change", "2"},
                                     {"points", "points"}};

std::string CellOf(const Json& object, const Column& column) {
  const Json* value = &object[column.key];
  if (!column.inner.empty() && value->is_object()) value = &(*value)[std::string(column.inner)];
  if (!column.inner.empty() && value->is_array()) value = &(*value)[static_cast<std::size_t>(column.inner[0] - '0')];
  if (value->is_null()) return "";
  return value->is_string() ? value->get<std::string>() : DumpJson(*value);
}

// One cell a column, `cell` of each, separated by commas.
template <typename Columns, typename Cell>
std::string Join(const Columns& columns, const Cell& cell) {
  std::string line;
  for (const Column& column : columns) line += (&column == std::begin(columns) ? "" : ",") + cell(column);
  return line;
}

std::string Line(const std::string& fruit, const std::string& defect) {
  return fruit + ',' + defect + "\r\n";
}

}  // namespace

const char* DefectClassName(DefectClass defect_class) {
  switch (defect_class) {
    case DefectClass::kIntact:
      return "intact";
    case DefectClass::kRainSpot:
      return "rain_spot";
    case DefectClass::kScar:
      return "scar";
    case DefectClass::kCrack:
      return "crack";
    case DefectClass::kDecay:
      return "decay";
  }
  return "intact";
}

Json ToJson(const Report& report) {
  const bool metric = report.scale_source == ScaleSource::kBoard;
  const MetricWriter mm(metric);
  Json fruits = Json::array();
  for (const Fruit& fruit : report.fruits) fruits.push_back(FruitJson(fruit, mm));
  return {{"id", report.id},
          {"created_at", report.created_at},
          {"software", std::string("drupe ") + kVersion},
          {"unit", metric ? Json("mm") : Json(nullptr)},
          {"scale_source", metric ? "board" : "none"},
          {"quality", report.quality},
          {"fruits", std::move(fruits)},
          {"timings_s", report.timings_s},
          {"provenance", ProvenanceJson(report.provenance)}};
}

std::string ToCsv(const Report& report) {
  const auto heading = [](const Column& column) { return std::string(column.heading); };
  std::string csv = Line(Join(kFruitColumns, heading), Join(kDefectColumns, heading));
  const Json json = ToJson(report);
  for (const Json& fruit : json["fruits"]) {
    const std::string cells = Join(kFruitColumns, [&](const Column& column) { return CellOf(fruit, column); });
    if (fruit["defects"].empty()) csv += Line(cells, Join(kDefectColumns, [](const Column&) { return std::string(); }));
    for (const Json& defect : fruit["defects"]) {
      csv += Line(cells, Join(kDefectColumns, [&](const Column& column) { return CellOf(defect, column); }));
    }
  }
  return csv;
}

}  // namespace drupe
