#include "defect_analysis/report/observations.h"

#include <string>

namespace drupe {
namespace {

constexpr char kMethod[] = "drupe.defect_analysis";

struct Trait {
  const char* key;    // in the report
  const char* trait;  // for people
  const char* scale;  // unit
};

constexpr Trait kFruitTraits[] = {{"volume_mm3", "volume", "mm3"},
                                  {"volume_uncertainty_mm3", "standard uncertainty of volume", "mm3"},
                                  {"surface_area_mm2", "surface area", "mm2"},
                                  {"surface_area_uncertainty_mm2", "standard uncertainty of surface area", "mm2"},
                                  {"sphericity", "sphericity", "none"},
                                  {"observed_surface_pct", "observed surface", "percent"},
                                  {"defect_area_pct", "defect area", "percent"}};

constexpr Trait kDefectTraits[] = {{"confidence", "confidence of the class", "none"},
                                   {"area_mm2", "area", "mm2"},
                                   {"area_uncertainty_mm2", "standard uncertainty of area", "mm2"},
                                   {"area_share_pct", "share of the fruit's surface", "percent"},
                                   {"diameter_mm", "equivalent diameter", "mm"},
                                   {"perimeter_mm", "perimeter", "mm"},
                                   {"perimeter_uncertainty_mm", "standard uncertainty of perimeter", "mm"},
                                   {"roundness", "roundness", "none"},
                                   {"length_mm", "length", "mm"},
                                   {"width_mm", "width", "mm"},
                                   {"depth_mm", "depth", "mm"},
                                   {"depth_uncertainty_mm", "standard uncertainty of depth", "mm"}};

Json Observation(const char* trait, const char* scale, const char* datatype, const Json& value, const Json& label) {
  return {{"trait", trait},       {"method", kMethod}, {"scale", scale},
          {"datatype", datatype}, {"value", value},    {"label", label}};
}

void AddNumber(const char* key, const char* trait, const char* scale, const Json& value, Json& sample) {
  if (!value.is_null()) sample[key] = Observation(trait, scale, "<class 'float'>", value, scale);
}

void AddText(const char* key, const char* trait, const Json& value, Json& sample) {
  sample[key] = Observation(trait, "none", "<class 'str'>", value, "none");
}

void AddColour(const char* key, const char* trait, const Json& value, Json& sample) {
  sample[key] = Observation(trait, "CIE 1976 Lab", "<class 'list'>", value, Json::array({"L", "a", "b"}));
}

Json FruitSample(const Json& fruit) {
  Json sample = Json::object();
  AddText("grade", "grade", fruit["grade"], sample);
  for (const Trait& t : kFruitTraits) AddNumber(t.key, t.trait, t.scale, fruit[t.key], sample);
  AddNumber("equatorial_diameter_mm", "equatorial diameter", "mm", fruit["diameter_mm"]["equatorial"], sample);
  AddNumber("polar_diameter_mm", "polar diameter", "mm", fruit["diameter_mm"]["polar"], sample);
  AddColour("mean_lab", "mean colour", fruit["mean_lab"], sample);
  AddColour("lab_spread", "standard deviation of colour", fruit["lab_spread"], sample);
  return sample;
}

Json DefectSample(const Json& defect) {
  Json sample = Json::object();
  AddText("class", "class", defect["class"], sample);
  for (const Trait& t : kDefectTraits) AddNumber(t.key, t.trait, t.scale, defect[t.key], sample);
  AddColour("mean_lab", "mean colour", defect["mean_lab"], sample);
  return sample;
}

}  // namespace

Json ObservationsJson(const Report& report) {
  const Json json = ToJson(report);
  Json observations = Json::object();
  for (const Json& fruit : json["fruits"]) {
    const std::string name = "fruit_" + DumpJson(fruit["id"]);
    observations[name] = FruitSample(fruit);
    for (const Json& defect : fruit["defects"]) {
      observations[name + "_defect_" + DumpJson(defect["id"])] = DefectSample(defect);
    }
  }
  return {{"metadata",
           {{"report", {{"label", "report"}, {"datatype", "<class 'str'>"}, {"value", Json::array({json["id"]})}}},
            {"software",
             {{"label", "software"}, {"datatype", "<class 'str'>"}, {"value", Json::array({json["software"]})}}}}},
          {"observations", std::move(observations)}};
}

}  // namespace drupe
