#pragma once

#include <functional>
#include <optional>
#include <string>

#include "base/json.h"
#include "base/run_context.h"
#include "base/status.h"

namespace drupe {

/// Remembers what was computed from pictures, between runs and between the work that is done while pictures arrive and
/// the job that uses it. Forgetting costs time and nothing else.
class DerivedCache {
 public:
  using Make = std::function<Result<std::string>()>;

  virtual ~DerivedCache() = default;

  /// The bytes kept under `key`; when there are none, those of `make`, which are then kept. Callers that ask for the
  /// same key at the same time share the work of the first, unless it takes long. Errors: those of `make`, and
  /// `cancelled`; a cache that cannot read or write is no error.
  virtual Result<std::string> FindOrMake(const std::string& key, const Make& make, const RunContext& context) = 0;

  /// The bytes kept under `key`; nothing when there are none, or none yet. For those who can do without.
  virtual std::optional<std::string> Find(const std::string& key) = 0;
};

/// A key under which what follows from `parameters` alone can be kept: 64 hexadecimal digits, different for each `kind`
/// of thing, and for each build of the program, since another build may compute it otherwise.
std::string DerivedKey(const std::string& kind, const Json& parameters);

}  // namespace drupe
