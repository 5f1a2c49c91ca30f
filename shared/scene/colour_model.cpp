#include "scene/colour_model.h"

#include <cmath>

#include "scene/model_file.h"

namespace drupe {
namespace {

using model_file::At;
using model_file::Invalid;
using model_file::ReadName;
using model_file::ReadNumber;

constexpr const char* kColourModelFormat = "drupe-colour-model";
constexpr double kMaxPlace = 1e4;   // of a normalised colour or a normalisation
constexpr double kMaxWeight = 1e6;  // of a support vector or the bias
constexpr double kMaxGamma = 1e4;

Result<Eigen::Vector3f> ReadVector(const Json& json, const std::string& field, double low, double high) {
  if (!json.is_array() || json.size() < 3) return Invalid(field, "must be three numbers");
  Eigen::Vector3f vector;
  for (int axis = 0; axis < 3; ++axis) {
    DRUPE_ASSIGN_OR_RETURN(const double value, ReadNumber(json[axis], field, low, high));
    vector[axis] = static_cast<float>(value);
  }
  return vector;
}

Status ReadVectors(const Json& json, ColourModel& model) {
  const std::string field = "support_vectors";
  if (!json.is_array() || json.empty() || json.size() > ColourModel::kMaxVectors) {
    return Invalid(field, "must be 1 to " + std::to_string(ColourModel::kMaxVectors) + " rows [x, y, z, weight]");
  }
  for (const Json& row : json) {
    if (!row.is_array() || row.size() != 4) return Invalid(field, "must be rows of four numbers");
    DRUPE_ASSIGN_OR_RETURN(const Eigen::Vector3f vector, ReadVector(row, field, -kMaxPlace, kMaxPlace));
    DRUPE_ASSIGN_OR_RETURN(const double weight, ReadNumber(row[3], field, -kMaxWeight, kMaxWeight));
    model.vectors.push_back(vector);
    model.weights.push_back(static_cast<float>(weight));
  }
  return Status::Ok();
}

Result<ConfusionTable> ReadConfusion(const Json& json, const std::string& field) {
  ConfusionTable table;
  const auto read = [&](const char* key, std::int64_t& count) -> Status {
    DRUPE_ASSIGN_OR_RETURN(const double value, ReadNumber(At(json, key), field + "." + key, 0, 1e12));
    count = static_cast<std::int64_t>(value);
    return Status::Ok();
  };
  DRUPE_RETURN_IF_ERROR(read("fruit_as_fruit", table.fruit_as_fruit));
  DRUPE_RETURN_IF_ERROR(read("fruit_as_background", table.fruit_as_background));
  DRUPE_RETURN_IF_ERROR(read("background_as_fruit", table.background_as_fruit));
  DRUPE_RETURN_IF_ERROR(read("background_as_background", table.background_as_background));
  return table;
}

Status ReadHead(const Json& json, ColourModel& model) {
  DRUPE_ASSIGN_OR_RETURN(model.name, ReadName(json, kColourModelFormat, ColourModel::kVersion));
  if (At(json, "kernel") != "rbf") return Invalid("kernel", "must be rbf");
  const Json& space = At(json, "colour_space");
  if (space != "lab" && space != "rgb") return Invalid("colour_space", "must be lab or rgb");
  model.space = space == "lab" ? ColourSpace::kLab : ColourSpace::kRgb;
  return Status::Ok();
}

Json ToJson(const Eigen::Vector3f& vector) {
  return {vector[0], vector[1], vector[2]};
}

}  // namespace

const char* ColourSpaceName(ColourSpace space) {
  return space == ColourSpace::kLab ? "lab" : "rgb";
}

Eigen::Vector3f PlaceOf(const Rgb8& colour, ColourSpace space) {
  return space == ColourSpace::kLab ? LabFromSrgb(colour) : Eigen::Vector3f(colour.cast<float>());
}

void ConfusionTable::Count(bool is_fruit, bool taken_for_fruit) {
  if (is_fruit) {
    ++(taken_for_fruit ? fruit_as_fruit : fruit_as_background);
  } else {
    ++(taken_for_fruit ? background_as_fruit : background_as_background);
  }
}

std::int64_t ConfusionTable::Points() const {
  return fruit_as_fruit + fruit_as_background + background_as_fruit + background_as_background;
}

double ConfusionTable::Accuracy() const {
  return Points() == 0 ? 0 : static_cast<double>(fruit_as_fruit + background_as_background) / Points();
}

double ConfusionTable::FruitError() const {
  const std::int64_t fruit = fruit_as_fruit + fruit_as_background;
  return fruit == 0 ? 0 : static_cast<double>(fruit_as_background) / static_cast<double>(fruit);
}

double ConfusionTable::BackgroundError() const {
  const std::int64_t background = background_as_fruit + background_as_background;
  return background == 0 ? 0 : static_cast<double>(background_as_fruit) / static_cast<double>(background);
}

Json ToJson(const ConfusionTable& table) {
  return {{"points", table.Points()},
          {"fruit_as_fruit", table.fruit_as_fruit},
          {"fruit_as_background", table.fruit_as_background},
          {"background_as_fruit", table.background_as_fruit},
          {"background_as_background", table.background_as_background},
          {"accuracy", table.Accuracy()},
          {"fruit_error", table.FruitError()},
          {"background_error", table.BackgroundError()}};
}

float ColourModel::DecideAt(const Eigen::Vector3f& normalised) const {
  double sum = bias;
  for (std::size_t i = 0; i < vectors.size(); ++i) {
    sum += weights[i] * std::exp(-gamma * (normalised - vectors[i]).squaredNorm());
  }
  return static_cast<float>(sum);
}

Json ToJson(const ColourModel& model) {
  Json rows = Json::array();
  for (std::size_t i = 0; i < model.vectors.size(); ++i) {
    const Eigen::Vector3f& vector = model.vectors[i];
    rows.push_back({vector[0], vector[1], vector[2], model.weights[i]});
  }
  return {{"format", kColourModelFormat},
          {"version", ColourModel::kVersion},
          {"name", model.name},
          {"colour_space", ColourSpaceName(model.space)},
          {"normalisation", {{"mean", ToJson(model.mean)}, {"scale", ToJson(model.scale)}}},
          {"kernel", "rbf"},
          {"gamma", model.gamma},
          {"c", model.c},
          {"bias", model.bias},
          {"confusion", {{"training", ToJson(model.training)}, {"test", ToJson(model.test)}}},
          {"source", model.source},
          {"support_vectors", std::move(rows)}};
}

Result<ColourModel> ParseColourModel(const Json& json) {
  ColourModel model;
  DRUPE_RETURN_IF_ERROR(ReadHead(json, model));
  const Json& normalisation = At(json, "normalisation");
  DRUPE_ASSIGN_OR_RETURN(model.mean,
                         ReadVector(At(normalisation, "mean"), "normalisation.mean", -kMaxPlace, kMaxPlace));
  DRUPE_ASSIGN_OR_RETURN(model.scale, ReadVector(At(normalisation, "scale"), "normalisation.scale", 1e-3, kMaxPlace));
  DRUPE_ASSIGN_OR_RETURN(const double gamma, ReadNumber(At(json, "gamma"), "gamma", 1e-6, kMaxGamma));
  DRUPE_ASSIGN_OR_RETURN(model.c, ReadNumber(At(json, "c"), "c", 1e-6, 1e6));
  DRUPE_ASSIGN_OR_RETURN(const double bias, ReadNumber(At(json, "bias"), "bias", -kMaxWeight, kMaxWeight));
  model.gamma = static_cast<float>(gamma);
  model.bias = static_cast<float>(bias);
  const Json& confusion = At(json, "confusion");
  DRUPE_ASSIGN_OR_RETURN(model.training, ReadConfusion(At(confusion, "training"), "confusion.training"));
  DRUPE_ASSIGN_OR_RETURN(model.test, ReadConfusion(At(confusion, "test"), "confusion.test"));
  if (At(json, "source").is_object()) model.source = At(json, "source");
  DRUPE_RETURN_IF_ERROR(ReadVectors(At(json, "support_vectors"), model));
  return model;
}

}  // namespace drupe
