#pragma once

#include <string>
#include <vector>

#include "base/run_context.h"
#include "reconstruction/dense/part_file.h"

namespace drupe::dense {

/// The finest maps of some views as bytes, which PartResult reads. Errors: `cancelled`.
Result<std::string> RefineViews(const LevelContext& fine, const std::vector<ViewWork>& work, const RunContext& run);

/// The finest maps of a part's views, out of what RunDensePart returned for it.
class PartResult {
 public:
  /// Errors: 422 `bad_part`, 400 as ParseJson.
  static Result<PartResult> Read(std::string bytes, std::size_t views);
  /// Of the k-th view of the part. `empty` is its map without patches. Errors: 422 `bad_part`.
  Result<PatchMap> MapOf(std::size_t k, PatchMap empty) const;

 private:
  std::string bytes_;
  std::vector<std::size_t> first_, count_;  ///< byte and number of each view's cells
};

}  // namespace drupe::dense
