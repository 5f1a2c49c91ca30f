#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <string>
#include <vector>

#include "base/json.h"
#include "base/status.h"
#include "image/colour.h"

namespace drupe {

enum class ColourSpace { kLab, kRgb };
const char* ColourSpaceName(ColourSpace space);  ///< "lab" or "rgb"
/// A colour's place in a space: L a b, or sRGB 0..255.
Eigen::Vector3f PlaceOf(const Rgb8& colour, ColourSpace space);

/// Points by what they are and what a model takes them for.
struct ConfusionTable {
  std::int64_t fruit_as_fruit = 0;
  std::int64_t fruit_as_background = 0;
  std::int64_t background_as_fruit = 0;
  std::int64_t background_as_background = 0;

  void Count(bool is_fruit, bool taken_for_fruit);
  std::int64_t Points() const;
  double Accuracy() const;         ///< share of points taken for what they are, 0..1; 0 without points
  double FruitError() const;       ///< share of the fruit's points taken for background (paper Table 4)
  double BackgroundError() const;  ///< share of the background's points taken for fruit
};
Json ToJson(const ConfusionTable& table);

/// Tells fruit from background by colour: a support vector machine with a radial kernel on normalised colours (paper
/// 4.1, Table 4). decision(x) = bias + sum_i weight_i exp(-gamma |x - vector_i|^2), x = (place - mean) / scale.
struct ColourModel {
  static constexpr int kVersion = 1;
  static constexpr std::size_t kMaxVectors = 20'000;

  std::string name;  ///< as CheckImageName allows
  ColourSpace space = ColourSpace::kLab;
  Eigen::Vector3f mean = Eigen::Vector3f::Zero();
  Eigen::Vector3f scale = Eigen::Vector3f::Ones();
  float gamma = 1;
  double c = 1;  ///< the price of a wrong training point
  float bias = 0;
  std::vector<Eigen::Vector3f> vectors;  ///< normalised
  std::vector<float> weights;            ///< one a vector; positive speaks for fruit
  ConfusionTable training;
  ConfusionTable test;           ///< of points that had no part in the training
  Json source = Json::object();  ///< what it was trained from

  /// Above zero: fruit. One kernel a support vector; ColourClassifier does millions of points.
  float Decide(const Rgb8& colour) const { return DecideAt((PlaceOf(colour, space) - mean).cwiseQuotient(scale)); }
  float DecideAt(const Eigen::Vector3f& normalised) const;
};

/// The model file, {"format": "drupe-colour-model", "version": 1, ...}.
Json ToJson(const ColourModel& model);

/// What is accepted of a model file.
inline constexpr std::size_t kMaxColourModelBytes = 4 << 20;

/// Reads a model file. Errors: 400 `invalid_model` with the field: another format or version, no or more than
/// kMaxVectors support vectors, numbers that are not finite or out of range.
Result<ColourModel> ParseColourModel(const Json& json);

}  // namespace drupe
