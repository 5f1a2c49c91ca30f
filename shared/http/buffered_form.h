#pragma once

#include <cstddef>
#include <set>
#include <string>
#include <string_view>

#include "base/json.h"
#include "http/multipart.h"

namespace drupe {

/// A PartSink that gathers one part at a time in memory. Of a part that is larger than its limit it keeps one byte more
/// than that, by which whoever reads it (ParseJson, VerifyImage) sees that it is too large.
class BufferedForm : public PartSink {
 public:
  Status BeginPart(const PartHead& head) final;
  Status WritePart(std::string_view bytes) final;
  Status EndPart() final;

 protected:
  /// Whether the part is taken, and how many bytes of it.
  virtual Result<std::size_t> LimitOf(const PartHead& head) = 0;
  /// Called with each whole part.
  virtual Status TakePart(const PartHead& head, std::string bytes) = 0;

  /// For LimitOf: `limit`, unless the part has come before: 400 `duplicate_part`.
  Result<std::size_t> OnlyOnce(const PartHead& head, std::size_t limit) const;
  /// 400 `unknown_part`, with the parts that there are.
  static Status UnknownPart(const PartHead& head, std::string_view known);
  /// Whether a part of this name has come.
  bool Has(std::string_view name) const { return names_.find(name) != names_.end(); }

 private:
  std::set<std::string, std::less<>> names_;  ///< of the parts that have come
  PartHead head_;
  std::string bytes_;
  std::size_t limit_ = 0;
};

}  // namespace drupe
