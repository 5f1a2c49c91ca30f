#pragma once

#include <string>

#include "base/json.h"
#include "base/status.h"

/// How trained models are read from their JSON files: every value is looked at before it is believed.
namespace drupe::model_file {

/// 400 `invalid_model`: "the model's FIELD WHAT".
Status Invalid(const std::string& field, const std::string& what);
/// The value under `key`; null when it is not there or `json` is no object.
const Json& At(const Json& json, const char* key);
/// Errors: 400 `invalid_model` for what is no number from `low` to `high`.
Result<double> ReadNumber(const Json& json, const std::string& field, double low, double high);
/// The model's name, after a look at "format" and "version". Errors: 400 `invalid_model`.
Result<std::string> ReadName(const Json& json, const std::string& format, int version);

}  // namespace drupe::model_file
