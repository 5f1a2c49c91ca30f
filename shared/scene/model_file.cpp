#include "scene/model_file.h"

#include <cmath>

#include "base/ids.h"

namespace drupe::model_file {

Status Invalid(const std::string& field, const std::string& what) {
  return InvalidArgument("invalid_model", "the model's " + field + " " + what, field);
}

const Json& At(const Json& json, const char* key) {
  static const Json kNull;
  const auto found = json.is_object() ? json.find(key) : json.end();
  return json.is_object() && found != json.end() ? *found : kNull;
}

Result<double> ReadNumber(const Json& json, const std::string& field, double low, double high) {
  const double value = json.is_number() ? json.get<double>() : NAN;
  if (value >= low && value <= high) return value;
  return Invalid(field, "must be a number from " + std::to_string(low) + " to " + std::to_string(high));
}

Result<std::string> ReadName(const Json& json, const std::string& format, int version) {
  if (At(json, "format") != format) return Invalid("format", "must be " + format);
  if (At(json, "version") != version) return Invalid("version", "must be " + std::to_string(version));
  const Json& name = At(json, "name");
  if (name.is_string() && CheckImageName(name.get<std::string>()).ok()) return name.get<std::string>();
  return Invalid("name", "must be 1 to 128 characters of [A-Za-z0-9._-], not starting with a dot");
}

}  // namespace drupe::model_file
