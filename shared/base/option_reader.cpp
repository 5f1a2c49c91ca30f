#include "base/option_reader.h"

#include <cmath>
#include <limits>

namespace drupe {

OptionReader::OptionReader(const Json& object, std::string path) : object_(object), path_(std::move(path)) {
  if (!object_.is_object()) error_ = InvalidArgument("invalid_option", path_ + " must be a JSON object", path_);
}

std::string OptionReader::PathOf(std::string_view key) const {
  return path_.empty() ? std::string(key) : path_ + "." + std::string(key);
}

const Json* OptionReader::Find(std::string_view key) {
  known_.emplace(key);
  if (!object_.is_object()) return nullptr;
  const auto found = object_.find(std::string(key));
  return found == object_.end() ? nullptr : &*found;
}

void OptionReader::Fail(std::string_view key, std::string_view expected) {
  if (!error_.ok()) return;
  const std::string field = PathOf(key);
  error_ = InvalidArgument("invalid_option", field + " must be " + std::string(expected), field);
}

void OptionReader::Read(std::string_view key, bool& value) {
  const Json* found = Find(key);
  if (found == nullptr) return;
  if (!found->is_boolean()) return Fail(key, "true or false");
  value = found->get<bool>();
}

void OptionReader::Read(std::string_view key, int& value) {
  const Json* found = Find(key);
  if (found == nullptr) return;
  const double number = found->is_number() ? found->get<double>() : std::numeric_limits<double>::quiet_NaN();
  if (!(std::abs(number) <= std::numeric_limits<int>::max()) || number != std::floor(number)) {
    return Fail(key, "a whole number");
  }
  value = static_cast<int>(number);
}

void OptionReader::Read(std::string_view key, double& value) {
  const Json* found = Find(key);
  if (found == nullptr) return;
  if (!found->is_number() || !std::isfinite(found->get<double>())) return Fail(key, "a number");
  value = found->get<double>();
}

void OptionReader::Read(std::string_view key, float& value) {
  double number = static_cast<double>(value);
  Read(key, number);
  value = static_cast<float>(number);
}

void OptionReader::Read(std::string_view key, std::string& value) {
  const Json* found = Find(key);
  if (found == nullptr) return;
  if (!found->is_string()) return Fail(key, "a string");
  value = found->get<std::string>();
}

const Json* OptionReader::Nested(std::string_view key) {
  const Json* found = Find(key);
  if (found == nullptr) return nullptr;
  if (!found->is_object()) {
    Fail(key, "a JSON object");
    return nullptr;
  }
  return found;
}

Status OptionReader::Finish() const {
  if (!error_.ok()) return error_;
  for (const auto& [key, value] : object_.items()) {
    if (known_.contains(key)) continue;
    std::string message = PathOf(key) + " is not an option; known here:";
    for (const std::string& name : known_) message += " " + name;
    return InvalidArgument("unknown_option", message, PathOf(key));
  }
  return Status::Ok();
}

}  // namespace drupe
