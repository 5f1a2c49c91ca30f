#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "base/stage_parts.h"
#include "reconstruction/sparse/cluster_models.h"

namespace drupe {

/// All that the model of one cluster is built from.
struct ClusterWork {
  SfmState state;                                  ///< as RestrictTo gives it
  std::vector<int> cluster;                        ///< view indices, ascending
  MatchGraph matches;                              ///< the verified pairs inside; is_static is empty
  std::vector<std::optional<Rigid3>> board_poses;  ///< per view of the whole set; of the cluster's alone
  std::uint64_t seed = 1;
};

std::string WriteClusterWork(ClusterWork& work);
/// Errors: 422 `bad_part`.
Result<ClusterWork> ReadClusterWork(std::string_view part);

std::string WriteSfmState(SfmState& state);
/// A state about as many views, tracks and observations as `sent`. Errors: 422 `bad_part`.
Result<SfmState> ReadSfmState(std::string_view bytes, const SfmState& sent);

}  // namespace drupe
