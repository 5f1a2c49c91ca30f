#pragma once

#include <string>

#include "base/json.h"
#include "base/status.h"

namespace drupe {

/// Background removal by colour (paper 4.1). Where the fruit stands in space decides first; colour only removes what
/// that leaves in doubt, and nothing from fruit whose colour the model does not know.
struct BackgroundOptions {
  std::string model = "default";  ///< "default", "none" (geometry alone), or the id of a trained model
  double known_share = 0.9;       ///< of a fruit's certain skin that a model must take for fruit to have a say; 0.5..1
  double doubt_mm = 0.25;         ///< points farther outside the skin than this are in doubt; 0..10
  double doubt_sigma = 3;         ///< and than this in standard deviations of the points across the skin; 0..100

  /// 400 `invalid_option` with the field.
  Status Check() const;
};

/// Reads the keys of BackgroundOptions. Errors as OptionReader::Finish and BackgroundOptions::Check.
Result<BackgroundOptions> ParseBackgroundOptions(const Json& json, const std::string& path);
Json ToJson(const BackgroundOptions& options);

}  // namespace drupe
