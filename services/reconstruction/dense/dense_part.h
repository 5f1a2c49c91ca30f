#pragma once

#include <string>
#include <vector>

#include "reconstruction/dense/patch_map.h"

namespace drupe::dense {

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
