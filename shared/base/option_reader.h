#pragma once

#include <set>
#include <string>
#include <string_view>
#include <vector>

#include "base/json.h"
#include "base/status.h"

namespace drupe {

/// Fills option structs from a JSON object of a request. Every key that is asked for is optional; a key nobody asked
/// for, a wrong type or a number that is not finite is an error that names the key with its path ("dense.level").
///
///   OptionReader reader(json, "options");
///   reader.Read("max_features", options.max_features);
///   if (const Json* dense = reader.Nested("dense")) ReadDense(*dense, reader.PathOf("dense"), ...);
///   DRUPE_RETURN_IF_ERROR(reader.Finish());
class OptionReader {
 public:
  /// Reads from `object`, which must outlive the reader. `path` leads the names in messages; may be empty.
  OptionReader(const Json& object, std::string path);

  void Read(std::string_view key, bool& value);
  void Read(std::string_view key, int& value);
  void Read(std::string_view key, double& value);
  void Read(std::string_view key, float& value);
  void Read(std::string_view key, std::string& value);

  /// The object under `key`, marked as known; nullptr when it is absent. Anything but an object is an error.
  const Json* Nested(std::string_view key);
  /// The path of `key`, for the reader of a nested object: "options.dense".
  std::string PathOf(std::string_view key) const;

  /// The first error: 400 `invalid_option` or `unknown_option`, with the field.
  Status Finish() const;

 private:
  const Json* Find(std::string_view key);
  void Fail(std::string_view key, std::string_view expected);

  const Json& object_;
  std::string path_;
  std::set<std::string, std::less<>> known_;
  Status error_;
};

}  // namespace drupe
