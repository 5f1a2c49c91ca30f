#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "base/status.h"
#include "cli/bench/truth_set.h"
#include "image/image.h"
#include "reconstruction/dense/dense.h"
#include "scene/point_cloud.h"

namespace drupe {

/// A set's dense cloud: CLOUDS/SET/dense.ply where `clouds` names a directory, otherwise reconstructed now.
Result<PointCloud> CloudOfSet(const TruthSet& set, const std::string& clouds, DenseOptions::Scene scene);

/// Which of a true fruit's defects covers each direction: an equirectangular map, column = azimuth from +x towards +y,
/// row = polar angle from +z; 0 healthy, k the k-th defect.
struct DefectMap {
  Eigen::Vector3d centre = Eigen::Vector3d::Zero();
  GrayImage labels;

  /// The label under a point, world frame.
  std::uint8_t LabelAt(const Eigen::Vector3d& point) const;
};

/// The maps of a rendered set's fruits, labels.png or labels-K.png; none when the set has no labels.png. Errors: 400
/// `bad_truth`, those of DecodeGray.
Result<std::vector<DefectMap>> LoadDefectMaps(const TruthSet& set);

}  // namespace drupe
