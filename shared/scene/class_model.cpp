#include "scene/class_model.h"

#include <algorithm>
#include <cmath>

#include "scene/model_file.h"

namespace drupe {
namespace {

using model_file::At;
using model_file::Invalid;
using model_file::ReadName;
using model_file::ReadNumber;

constexpr const char* kClassModelFormat = "drupe-class-model";
constexpr double kLeast = 1e-6;     // of what a logarithm is taken of
constexpr double kMaxNumber = 1e4;  // of a mean, a scale, a weight
constexpr double kLeastScale = 1e-4;
constexpr double kMaxDefects = 1e9;
constexpr DefectClass kClasses[] = {DefectClass::kRainSpot, DefectClass::kScar, DefectClass::kCrack,
                                    DefectClass::kDecay};

Status ReadFeatures(const Json& json, ClassModel& model) {
  if (!json.is_array() || json.size() != kClassFeatures) {
    return Invalid("features", "must be " + std::to_string(kClassFeatures) + " objects");
  }
  for (int k = 0; k < kClassFeatures; ++k) {
    if (At(json[k], "name") != kClassFeatureNames[k]) {
      return Invalid("features", std::string("must have ") + kClassFeatureNames[k] + " in its place");
    }
    DRUPE_ASSIGN_OR_RETURN(model.mean[k], ReadNumber(At(json[k], "mean"), "features.mean", -kMaxNumber, kMaxNumber));
    DRUPE_ASSIGN_OR_RETURN(model.scale[k], ReadNumber(At(json[k], "scale"), "features.scale", kLeastScale, kMaxNumber));
  }
  return Status::Ok();
}

Status ReadClass(const Json& json, ClassModel& model) {
  const Json& name = At(json, "class");
  const auto found = name.is_string() ? DefectClassOf(name.get<std::string>()) : std::nullopt;
  if (!found || (!model.classes.empty() && model.classes.back() >= *found)) {
    return Invalid("classes", "must be of rain_spot, scar, crack and decay, in this order");
  }
  const Json& weights = At(json, "weights");
  if (!weights.is_array() || weights.size() != kClassFeatures) {
    return Invalid("classes.weights", "must have one number a feature");
  }
  const auto row = static_cast<Eigen::Index>(model.classes.size());
  DRUPE_ASSIGN_OR_RETURN(model.bias[row], ReadNumber(At(json, "bias"), "classes.bias", -kMaxNumber, kMaxNumber));
  for (int k = 0; k < kClassFeatures; ++k) {
    DRUPE_ASSIGN_OR_RETURN(model.weights(row, k), ReadNumber(weights[k], "classes.weights", -kMaxNumber, kMaxNumber));
  }
  model.classes.push_back(*found);
  return Status::Ok();
}

Status ReadClasses(const Json& json, ClassModel& model) {
  if (!json.is_array() || json.size() < 2 || json.size() > std::size(kClasses)) {
    return Invalid("classes", "must be two to four objects");
  }
  model.weights.resize(static_cast<Eigen::Index>(json.size()), Eigen::NoChange);
  model.bias.resize(static_cast<Eigen::Index>(json.size()));
  for (const Json& one : json) DRUPE_RETURN_IF_ERROR(ReadClass(one, model));
  return Status::Ok();
}

Result<ClassConfusion> ReadConfusion(const Json& json, std::size_t classes, const std::string& field) {
  const std::string wanted = "must have one row a class, with one count a class";
  if (!json.is_array() || json.size() != classes) return Invalid(field, wanted);
  const auto size = static_cast<Eigen::Index>(classes);
  ClassConfusion table(size, size);
  for (Eigen::Index row = 0; row < size; ++row) {
    const Json& counts = json[static_cast<std::size_t>(row)];
    if (!counts.is_array() || counts.size() != classes) return Invalid(field, wanted);
    for (Eigen::Index column = 0; column < size; ++column) {
      DRUPE_ASSIGN_OR_RETURN(const double count,
                             ReadNumber(counts[static_cast<std::size_t>(column)], field, 0, kMaxDefects));
      table(row, column) = static_cast<std::int64_t>(count);
    }
  }
  return table;
}

Status ReadHead(const Json& json, ClassModel& model) {
  DRUPE_ASSIGN_OR_RETURN(model.name, ReadName(json, kClassModelFormat, ClassModel::kVersion));
  DRUPE_ASSIGN_OR_RETURN(model.ridge, ReadNumber(At(json, "ridge"), "ridge", 0, kMaxNumber));
  DRUPE_ASSIGN_OR_RETURN(const double reports, ReadNumber(At(json, "reports"), "reports", 0, kMaxDefects));
  model.reports = static_cast<std::int64_t>(reports);
  return Status::Ok();
}

Json ToJson(const ClassConfusion& table) {
  Json rows = Json::array();
  for (Eigen::Index row = 0; row < table.rows(); ++row) {
    Json counts = Json::array();
    for (Eigen::Index column = 0; column < table.cols(); ++column) counts.push_back(table(row, column));
    rows.push_back(std::move(counts));
  }
  return rows;
}

Json ClassesJson(const ClassModel& model) {
  Json classes = Json::array();
  for (Eigen::Index row = 0; row < model.weights.rows(); ++row) {
    Json weights = Json::array();
    for (int k = 0; k < kClassFeatures; ++k) weights.push_back(model.weights(row, k));
    classes.push_back({{"class", DefectClassName(model.classes[static_cast<std::size_t>(row)])},
                       {"bias", model.bias[row]},
                       {"weights", std::move(weights)}});
  }
  return classes;
}

}  // namespace

ClassFeatures FeaturesOf(const Defect& defect) {
  const double width = std::max(kLeast, defect.width_mm);
  ClassFeatures features;
  features << std::log(std::max(kLeast, defect.area_mm2)), std::log(std::max(kLeast, defect.length_mm) / width),
      defect.roundness, width, defect.depth_mm, defect.lab_change;
  return features;
}

std::optional<DefectClass> DefectClassOf(std::string_view name) {
  const auto* found =
      std::find_if(std::begin(kClasses), std::end(kClasses), [&](DefectClass c) { return name == DefectClassName(c); });
  return found == std::end(kClasses) ? std::nullopt : std::optional<DefectClass>(*found);
}

Eigen::VectorXd ClassModel::Probabilities(const ClassFeatures& features) const {
  ClassFeatures standardised = (features - mean).cwiseQuotient(scale);
  for (double& value : standardised) value = std::isfinite(value) ? value : 0;
  Eigen::VectorXd scores = weights * standardised + bias;
  scores = (scores.array() - scores.maxCoeff()).exp();
  return scores / scores.sum();
}

Classification ClassModel::Classify(const ClassFeatures& features) const {
  Eigen::Index best = 0;
  const double probability = Probabilities(features).maxCoeff(&best);
  return {classes[static_cast<std::size_t>(best)], probability};
}

Json ToJson(const ClassModel& model) {
  Json features = Json::array();
  for (int k = 0; k < kClassFeatures; ++k) {
    features.push_back({{"name", kClassFeatureNames[k]}, {"mean", model.mean[k]}, {"scale", model.scale[k]}});
  }
  return {{"format", kClassModelFormat},
          {"version", ClassModel::kVersion},
          {"name", model.name},
          {"ridge", model.ridge},
          {"reports", model.reports},
          {"features", std::move(features)},
          {"classes", ClassesJson(model)},
          {"confusion", {{"training", ToJson(model.training)}, {"left_out", ToJson(model.left_out)}}}};
}

Result<ClassModel> ParseClassModel(const Json& json) {
  ClassModel model;
  DRUPE_RETURN_IF_ERROR(ReadHead(json, model));
  DRUPE_RETURN_IF_ERROR(ReadFeatures(At(json, "features"), model));
  DRUPE_RETURN_IF_ERROR(ReadClasses(At(json, "classes"), model));
  const Json& confusion = At(json, "confusion");
  const std::size_t count = model.classes.size();
  DRUPE_ASSIGN_OR_RETURN(model.training, ReadConfusion(At(confusion, "training"), count, "confusion.training"));
  DRUPE_ASSIGN_OR_RETURN(model.left_out, ReadConfusion(At(confusion, "left_out"), count, "confusion.left_out"));
  return model;
}

}  // namespace drupe
