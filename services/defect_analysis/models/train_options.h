#pragma once

#include <string>

#include "base/json.h"
#include "base/status.h"
#include "scene/colour_model.h"

namespace drupe {

/// Training of a background model (paper 4.1).
struct TrainOptions {
  std::string name = "background";        ///< as CheckImageName allows
  ColourSpace space = ColourSpace::kLab;  ///< "lab" or "rgb"; the paper: Lab generalises better
  double c = 10;                          ///< price of a wrong training point; 0.001..100000
  double gamma = 0.5;                     ///< of the kernel, on colours normalised to unit deviation; 0.001..1000
  int max_points = 3000;                  ///< of each class, rare colours first; 50..50000
  double test_share = 0.25;               ///< of the points, kept from training where no test points are given; 0..0.9
  int recoloured = 0;                     ///< copies of the fruit in other hues and lightness, so that fruit of
                                          ///< colours that are not in the data is known too; 0..24

  Status Check() const;
};

/// Reads the keys of TrainOptions. Errors: 400 `unknown_option`, `invalid_option` with the field.
Result<TrainOptions> ParseTrainOptions(const Json& json);
Json ToJson(const TrainOptions& options);

}  // namespace drupe
