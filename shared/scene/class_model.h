#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "base/json.h"
#include "base/status.h"
#include "scene/report.h"

namespace drupe {

/// A defect's class and how sure that is.
struct Classification {
  DefectClass defect_class = DefectClass::kRainSpot;
  double confidence = 0;  ///< 0..1
};

/// What a trained classifier looks at, in this order; a report states all of it.
inline constexpr std::array<const char*, 8> kClassFeatureNames = {"log_area",        ///< natural logarithm of area_mm2
                                                                  "log_elongation",  ///< of length_mm / width_mm
                                                                  "roundness",      "width_mm", "depth_mm",
                                                                  "change_l",       "change_a", "change_b"};
inline constexpr int kClassFeatures = static_cast<int>(kClassFeatureNames.size());
using ClassFeatures = Eigen::Matrix<double, kClassFeatures, 1>;

/// Of a defect in mm.
ClassFeatures FeaturesOf(const Defect& defect);

/// The class of a name; nothing for a name that is no class of a defect ("intact" is none).
std::optional<DefectClass> DefectClassOf(std::string_view name);

/// Defects by what they are (row) and what a model takes them for (column), in the order of the model's classes.
using ClassConfusion = Eigen::Matrix<std::int64_t, Eigen::Dynamic, Eigen::Dynamic>;

/// Tells the classes of defects apart: multinomial logistic regression. With z = (features - mean) / scale, a class's
/// probability is proportional to exp(weights . z + bias), and the most probable class wins.
struct ClassModel {
  static constexpr int kVersion = 1;

  std::string name;                  ///< as CheckImageName allows
  std::vector<DefectClass> classes;  ///< 2 to 4, ascending severity
  ClassFeatures mean = ClassFeatures::Zero();
  ClassFeatures scale = ClassFeatures::Ones();
  Eigen::Matrix<double, Eigen::Dynamic, kClassFeatures> weights;  ///< one row a class, of standardised features
  Eigen::VectorXd bias;                                           ///< one a class
  double ridge = 1;                                               ///< the penalty that it was trained with
  std::int64_t reports = 0;                                       ///< that it was trained from
  ClassConfusion training;                                        ///< of the defects that it was trained from
  ClassConfusion left_out;  ///< of each report by a model of the other reports; zero where there were none

  /// One a class, adding up to 1. A feature that is not finite says nothing.
  Eigen::VectorXd Probabilities(const ClassFeatures& features) const;
  /// The most probable class with its probability; of equals the mildest.
  Classification Classify(const ClassFeatures& features) const;
};

/// The model file, {"format": "drupe-class-model", "version": 1, ...}.
Json ToJson(const ClassModel& model);

/// Reads a model file. Errors: 400 `invalid_model` with the field: another format, version or list of features, fewer
/// than two classes, a class named twice or out of order, numbers that are not finite or out of range.
Result<ClassModel> ParseClassModel(const Json& json);

}  // namespace drupe
