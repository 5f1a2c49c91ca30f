#include "scene/report.h"

#include <cmath>

#include "base/version.h"

namespace drupe {
namespace {

// Digits beyond these are noise, and the reader has to pass over them.
constexpr int kLengthDigits = 4;  // 0.1 micrometres
constexpr int kRatioDigits = 4;
constexpr int kColourDigits = 2;

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
          {"area_share_pct", Rounded(defect.area_share_pct, kRatioDigits)},
          {"perimeter_mm", mm(defect.perimeter_mm)},
          {"roundness", Rounded(defect.roundness, kRatioDigits)},
          {"plane", PlaneJson(defect.plane, mm)},
          {"contour_mm", mm(defect.contour_mm)},
          {"mean_lab", VectorJson(defect.mean_lab, kColourDigits)},
          {"points", defect.points}};
}

Json FruitJson(const Fruit& fruit, const MetricWriter& mm) {
  Json json = {
      {"id", fruit.id},
      {"grade", DefectClassName(fruit.grade)},
      {"centre_mm", mm(fruit.centre_mm)},
      {"volume_mm3", mm(fruit.volume_mm3)},
      {"surface_area_mm2", mm(fruit.surface_area_mm2)},
      {"diameter_mm", {{"equatorial", mm(fruit.equatorial_diameter_mm)}, {"polar", mm(fruit.polar_diameter_mm)}}},
      {"sphericity", Rounded(fruit.sphericity, kRatioDigits)},
      {"mean_lab", VectorJson(fruit.mean_lab, kColourDigits)},
      {"observed_surface_pct", Rounded(fruit.observed_surface_pct, 2)},
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

std::string Cell(const Json& value) {
  return value.is_null() ? "" : DumpJson(value);
}

std::string FruitCells(const Json& fruit) {
  return Cell(fruit["id"]) + ',' + fruit["grade"].get<std::string>() + ',' + Cell(fruit["volume_mm3"]) + ',' +
         Cell(fruit["surface_area_mm2"]) + ',' + Cell(fruit["diameter_mm"]["equatorial"]) + ',' +
         Cell(fruit["diameter_mm"]["polar"]) + ',' + Cell(fruit["sphericity"]) + ',' + Cell(fruit["defect_area_pct"]);
}

std::string DefectCells(const Json& defect) {
  std::string line = Cell(defect["id"]) + ',' + defect["class"].get<std::string>();
  for (const char* key : {"confidence", "area_mm2", "area_uncertainty_mm2", "planar_area_mm2", "area_share_pct",
                          "perimeter_mm", "roundness"}) {
    line += ',' + Cell(defect[key]);
  }
  for (int axis = 0; axis < 3; ++axis) {
    line += ',';
    if (!defect["centre_mm"].is_null()) line += Cell(defect["centre_mm"][axis]);
  }
  for (int channel = 0; channel < 3; ++channel) line += ',' + Cell(defect["mean_lab"][channel]);
  return line + ',' + Cell(defect["points"]);
}

constexpr char kCsvHeader[] =
    "fruit,grade,volume_mm3,surface_area_mm2,equatorial_diameter_mm,polar_diameter_mm,sphericity,defect_area_pct,"
    "defect,class,confidence,area_mm2,area_uncertainty_mm2,planar_area_mm2,area_share_pct,perimeter_mm,roundness,"
    "centre_x_mm,centre_y_mm,centre_z_mm,mean_l,mean_a,mean_b,points\r\n";
constexpr char kNoDefectCells[] = ",,,,,,,,,,,,,,,";

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
  std::string csv = kCsvHeader;
  const Json json = ToJson(report);
  for (const Json& fruit : json["fruits"]) {
    if (fruit["defects"].empty()) csv += FruitCells(fruit) + ',' + kNoDefectCells + "\r\n";
    for (const Json& defect : fruit["defects"]) csv += FruitCells(fruit) + ',' + DefectCells(defect) + "\r\n";
  }
  return csv;
}

}  // namespace drupe
