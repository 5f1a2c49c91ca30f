#include "defect_analysis/models/labelled_defects.h"

#include <cmath>

namespace drupe {
namespace {

constexpr std::size_t kMaxFruits = 100;
constexpr std::size_t kMaxDefects = 10'000;
constexpr double kMaxMeasure = 1e6;  // mm, mm^2, or units of Lab

Status Bad(const std::string& field, const std::string& what) {
  return InvalidArgument("bad_report", "the report's " + field + " " + what, field);
}

// A number of a defect, or the error in `status`, which keeps the first.
class MeasureReader {
 public:
  MeasureReader(const Json& defect, std::string path) : defect_(defect), path_(std::move(path)) {}

  const Json* Find(const char* key) const {
    const auto found = defect_.find(key);
    return found == defect_.end() ? nullptr : &*found;
  }
  double Read(const char* key) { return Check(Find(key), key); }
  Eigen::Vector3d ReadColour(const char* key) {
    const Json* found = Find(key);
    Eigen::Vector3d colour = Eigen::Vector3d::Zero();
    const bool three = found != nullptr && found->is_array() && found->size() == 3;
    for (int c = 0; c < 3; ++c) colour[c] = Check(three ? &(*found)[static_cast<std::size_t>(c)] : nullptr, key);
    return colour;
  }
  DefectClass ReadClass() {
    const Json* found = Find("class");
    const auto known = found != nullptr && found->is_string() ? DefectClassOf(found->get<std::string>()) : std::nullopt;
    if (!known && status_.ok()) status_ = Bad(path_ + ".class", "must be rain_spot, scar, crack or decay");
    return known.value_or(DefectClass::kRainSpot);
  }
  const Status& status() const { return status_; }

 private:
  double Check(const Json* json, const char* key) {
    const double value = json != nullptr && json->is_number() ? json->get<double>() : NAN;
    if (std::abs(value) <= kMaxMeasure) return value;
    if (status_.ok()) status_ = Bad(path_ + "." + key, "must be there, and within a million");
    return 0;
  }

  const Json& defect_;
  std::string path_;
  Status status_;
};

Result<LabelledDefect> ReadDefect(const Json& json, const std::string& path) {
  if (!json.is_object()) return Bad(path, "must be a JSON object");
  MeasureReader reader(json, path);
  Defect defect;
  defect.area_mm2 = reader.Read("area_mm2");
  defect.length_mm = reader.Read("length_mm");
  defect.width_mm = reader.Read("width_mm");
  defect.roundness = reader.Read("roundness");
  defect.depth_mm = reader.Read("depth_mm");
  defect.lab_change = reader.ReadColour("lab_change");
  const LabelledDefect labelled{FeaturesOf(defect), reader.ReadClass()};
  DRUPE_RETURN_IF_ERROR(reader.status());
  return labelled;
}

// The list under `key`, or the error that says what it must be.
Result<const Json*> ListOf(const Json& json, const char* key, const std::string& path, std::size_t most) {
  const auto found = json.is_object() ? json.find(key) : json.end();
  if (json.is_object() && found != json.end() && found->is_array() && found->size() <= most) return &*found;
  return Bad(path, "must be a list of at most " + std::to_string(most));
}

}  // namespace

Result<std::vector<LabelledDefect>> ReadLabelledReport(const Json& report) {
  DRUPE_ASSIGN_OR_RETURN(const Json* fruits, ListOf(report, "fruits", "fruits", kMaxFruits));
  const auto unit = report.find("unit");
  if (unit == report.end() || *unit != "mm") {
    return Unprocessable("no_scale", "the report is not in mm: without a board on the pictures sizes say nothing");
  }
  std::vector<LabelledDefect> labelled;
  for (std::size_t f = 0; f < fruits->size(); ++f) {
    const std::string path = "fruits[" + std::to_string(f) + "].defects";
    DRUPE_ASSIGN_OR_RETURN(const Json* defects, ListOf((*fruits)[f], "defects", path, kMaxDefects));
    for (std::size_t d = 0; d < defects->size(); ++d) {
      DRUPE_ASSIGN_OR_RETURN(const LabelledDefect defect,
                             ReadDefect((*defects)[d], path + "[" + std::to_string(d) + "]"));
      labelled.push_back(defect);
    }
  }
  return labelled;
}

}  // namespace drupe
