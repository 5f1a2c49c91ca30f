#pragma once

#include <vector>

#include "base/run_context.h"
#include "geometry/sim3.h"
#include "reconstruction/sparse/cluster_models.h"
#include "reconstruction/sparse/sparse_options.h"

namespace drupe {

/// How two cluster models lie to one another.
struct ClusterLink {
  int first = 0, second = 0;  ///< clusters, first < second
  Sim3 second_from_first;
  int inliers = 0;  ///< shared points and cameras that agree
};

/// The links between all clusters that share enough: robust similarities from the positions of shared tracks and the
/// centres of shared cameras.
std::vector<ClusterLink> LinkClusters(const std::vector<ClusterModel>& models, const SparseOptions& options,
                                      const RunContext& context);

/// Brings the cluster models into one frame along the maximum spanning tree of their links (paper 3.1.2) and sets the
/// poses of `whole`. Models in the board's frame are in one frame already; the others join them or, without any, the
/// largest. Models that no link reaches are left out. A view of several clusters has the pose of the one that holds
/// most of its observations. False when there is no pose at all.
bool FuseClusters(const std::vector<ClusterModel>& models, const SparseOptions& options, const RunContext& context,
                  SfmState& whole);

}  // namespace drupe
