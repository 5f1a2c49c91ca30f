#pragma once

#include <string>
#include <vector>

#include "base/status.h"
#include "defect_analysis/models/labelled_defects.h"
#include "scene/class_model.h"

namespace drupe {

/// Training of a classifier of defects.
struct ClassTrainOptions {
  std::string name = "classes";  ///< of the model; as CheckImageName allows
  /// Weight of half the squared weights against the sum of the defects' log-likelihoods; 0.001..1000. More makes
  /// confidences lower and keeps few defects from being learnt by heart.
  double ridge = 0.3;

  Status Check() const;
};

/// Multinomial logistic regression with a ridge on standardised features, by Newton's method: the penalised likelihood
/// is strictly concave, so there is one best model, and the same reports give the same bytes. `reports`: the defects of
/// each; fruit of one report must not be in another, or the table of left-out reports is too good.
/// Errors: 400 `invalid_option`; 422 `no_defects`, `one_class`, `training_failed` (features that are not finite).
Result<ClassModel> TrainClassModel(const std::vector<std::vector<LabelledDefect>>& reports,
                                   const ClassTrainOptions& options);

}  // namespace drupe
