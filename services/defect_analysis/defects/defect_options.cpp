#include "defect_analysis/defects/defect_options.h"

#include <concepts>
#include <type_traits>

#include "base/option_check.h"

namespace drupe {
namespace {

bool IsWithin(double value, double low, double high) {
  return value >= low && value <= high;
}

// The fields of each group, named once for reading and writing. `visit(name, field)`.
template <typename Options, typename Visit>
requires std::same_as<std::remove_const_t<Options>, SegmentationOptions>
void VisitFields(Options& o, const Visit& visit) {
  visit("min_clusters", o.min_clusters);
  visit("max_clusters", o.max_clusters);
  visit("max_iterations", o.max_iterations);
  visit("lightness_weight", o.lightness_weight);
  visit("significance_delta_e", o.significance_delta_e);
  visit("significance_sigma", o.significance_sigma);
  visit("faint_share", o.faint_share);
  visit("faintest_share", o.faintest_share);
  visit("local_sigma", o.local_sigma);
}

template <typename Options, typename Visit>
requires std::same_as<std::remove_const_t<Options>, ClusterOptions>
void VisitFields(Options& o, const Visit& visit) {
  visit("min_area_mm2", o.min_area_mm2);
  visit("bridge_mm", o.bridge_mm);
  visit("merge_distance_mm", o.merge_distance_mm);
  visit("max_defects", o.max_defects);
}

template <typename Options, typename Visit>
requires std::same_as<std::remove_const_t<Options>, PlaneOptions>
void VisitFields(Options& o, const Visit& visit) {
  visit("iterations", o.iterations);
  visit("distance", o.distance);
  visit("distance_mm", o.distance_mm);
}

template <typename Options, typename Visit>
requires std::same_as<std::remove_const_t<Options>, ContourOptions>
void VisitFields(Options& o, const Visit& visit) {
  visit("control_points", o.control_points);
  visit("degree", o.degree);
  visit("sampling_density", o.sampling_density);
  visit("level", o.level);
}

template <typename Options, typename Visit>
requires std::same_as<std::remove_const_t<Options>, ClassOptions>
void VisitFields(Options& o, const Visit& visit) {
  visit("decay_min_area_mm2", o.decay_min_area_mm2);
  visit("elongated_min", o.elongated_min);
  visit("crack_max_width_mm", o.crack_max_width_mm);
  visit("decay_min_depth_mm", o.decay_min_depth_mm);
  visit("crack_min_depth_mm", o.crack_min_depth_mm);
  visit("crack_max_lightness", o.crack_max_lightness);
}

template <typename Options, typename Visit>
requires std::same_as<std::remove_const_t<Options>, DefectOptions>
void VisitGroups(Options& o, const Visit& visit) {
  visit("segmentation", o.segmentation);
  visit("cluster", o.cluster);
  visit("plane", o.plane);
  visit("contour", o.contour);
  visit("class", o.classes);
}

// "rules", or a model inline.
Status ReadClassModel(const Json& json, OptionReader& fields, std::optional<ClassModel>& model) {
  if (const auto found = json.find("model"); found == json.end() || !found->is_object()) {
    std::string name = "rules";
    fields.Read("model", name);
    return name == "rules" ? Status::Ok() : RefuseOption("class.model", "\"rules\" or the content of a model file");
  }
  Result<ClassModel> read = ParseClassModel(*fields.Nested("model"));
  if (!read.ok()) {
    return InvalidArgument(read.status().code(), read.status().message(),
                           fields.PathOf("model") + "." + read.status().field());
  }
  model = std::move(*read);
  return Status::Ok();
}

// What a group has beside plain fields.
template <typename Options>
Status ReadRest(const Json& json, OptionReader& fields, Options& options) {
  if constexpr (std::same_as<Options, ClassOptions>) return ReadClassModel(json, fields, options.model);
  return Status::Ok();
}

}  // namespace

Status ReadDefectOptions(OptionReader& reader, DefectOptions& options) {
  Status first;
  VisitGroups(options, [&](const char* name, auto& group) {
    const Json* json = reader.Nested(name);
    if (json == nullptr || !first.ok()) return;
    OptionReader fields(*json, reader.PathOf(name));
    VisitFields(group, [&](const char* key, auto& field) { fields.Read(key, field); });
    first = ReadRest(*json, fields, group);
    if (first.ok()) first = fields.Finish();
  });
  return first;
}

Json ToJson(const DefectOptions& options) {
  Json json = Json::object();
  VisitGroups(options, [&](const char* name, const auto& group) {
    Json fields = Json::object();
    VisitFields(group, [&](const char* key, const auto& field) { fields[key] = field; });
    json[name] = std::move(fields);
  });
  json["class"]["model"] = options.classes.model ? ToJson(*options.classes.model) : Json("rules");
  return json;
}

Status SegmentationOptions::Check() const {
  if (min_clusters < 2 || min_clusters > 16) return RefuseOption("segmentation.min_clusters", "2 to 16");
  if (max_clusters < min_clusters || max_clusters > 16)
    return RefuseOption("segmentation.max_clusters", "min_clusters to 16");
  if (max_iterations < 1 || max_iterations > 1000) return RefuseOption("segmentation.max_iterations", "1 to 1000");
  if (!IsWithin(lightness_weight, 0, 1)) return RefuseOption("segmentation.lightness_weight", "0 to 1");
  if (!IsWithin(significance_delta_e, 1, 100)) return RefuseOption("segmentation.significance_delta_e", "1 to 100");
  if (!IsWithin(significance_sigma, 1, 100)) return RefuseOption("segmentation.significance_sigma", "1 to 100");
  if (!IsWithin(faint_share, 0.3, 1)) return RefuseOption("segmentation.faint_share", "0.3 to 1");
  if (!IsWithin(faintest_share, 0.3, 1)) return RefuseOption("segmentation.faintest_share", "0.3 to 1");
  if (!IsWithin(local_sigma, 0, 100)) return RefuseOption("segmentation.local_sigma", "0 to 100");
  return Status::Ok();
}

Status ClusterOptions::Check() const {
  if (!IsWithin(min_area_mm2, 0.01, 1e4)) return RefuseOption("cluster.min_area_mm2", "0.01 to 10000");
  if (!IsWithin(bridge_mm, 0, 10)) return RefuseOption("cluster.bridge_mm", "0 to 10");
  if (!IsWithin(merge_distance_mm, 0, 5)) return RefuseOption("cluster.merge_distance_mm", "0 to 5");
  if (max_defects < 1 || max_defects > 10000) return RefuseOption("cluster.max_defects", "1 to 10000");
  return Status::Ok();
}

Status PlaneOptions::Check() const {
  if (iterations < 1 || iterations > 10000) return RefuseOption("plane.iterations", "1 to 10000");
  if (!IsWithin(distance, 0, 1)) return RefuseOption("plane.distance", "0 to 1");
  if (!IsWithin(distance_mm, 0, 10)) return RefuseOption("plane.distance_mm", "0 to 10");
  return Status::Ok();
}

Status ContourOptions::Check() const {
  if (degree < 1 || degree > 5) return RefuseOption("contour.degree", "1 to 5");
  if (control_points <= degree || control_points > 200)
    return RefuseOption("contour.control_points", "degree + 1 to 200");
  if (sampling_density < 1 || sampling_density > 1000) return RefuseOption("contour.sampling_density", "1 to 1000");
  if (!IsWithin(level, 0.05, 0.95)) return RefuseOption("contour.level", "0.05 to 0.95");
  return Status::Ok();
}

Status ClassOptions::Check() const {
  if (!(decay_min_area_mm2 > 0)) return RefuseOption("class.decay_min_area_mm2", "greater than 0");
  if (!(elongated_min >= 1)) return RefuseOption("class.elongated_min", "at least 1");
  if (!(crack_max_width_mm > 0)) return RefuseOption("class.crack_max_width_mm", "greater than 0");
  if (!IsWithin(decay_min_depth_mm, 0, 100)) return RefuseOption("class.decay_min_depth_mm", "0 to 100");
  if (!IsWithin(crack_min_depth_mm, 0, 100)) return RefuseOption("class.crack_min_depth_mm", "0 to 100");
  if (!IsWithin(crack_max_lightness, -100, 100)) return RefuseOption("class.crack_max_lightness", "-100 to 100");
  return Status::Ok();
}

Status DefectOptions::Check() const {
  DRUPE_RETURN_IF_ERROR(segmentation.Check());
  DRUPE_RETURN_IF_ERROR(cluster.Check());
  DRUPE_RETURN_IF_ERROR(plane.Check());
  DRUPE_RETURN_IF_ERROR(contour.Check());
  return classes.Check();
}

}  // namespace drupe
