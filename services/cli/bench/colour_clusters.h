#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <optional>
#include <vector>

namespace drupe {

/// Colours of points in some space, divided into classes; the vectors have equal length.
struct ColourClusters {
  std::vector<Eigen::Vector3f> colours;
  std::vector<std::uint8_t> class_of;
  int classes = 0;
  double cpu_s = 0;  ///< what dividing them took
};

/// OpenCV's K-means on the colours: from random centres (K-means) or spread ones (K-means++, Arthur and Vassilvitskii
/// 2007), one attempt, at most 30 iterations.
ColourClusters ClusterByOpenCv(const std::vector<Eigen::Vector3f>& colours, int classes, bool spread_centres);

/// The colours' classes by the nearest of some centres, at least one and at most 256; cpu_s is left at 0.
ColourClusters ClusterByNearest(const std::vector<Eigen::Vector3f>& colours,
                                const std::vector<Eigen::Vector3f>& centres);

/// The Davies-Bouldin index over all points (Davies and Bouldin 1979); nothing for fewer than two classes with points.
std::optional<double> DaviesBouldinIndex(const ColourClusters& clusters);

/// How well the classes tell defects from skin: the intersection over union of the true defects' points and those of
/// the classes that are called defect. `first_is_skin`: class 0 is skin and all others are defects, as ours says of
/// itself; otherwise the choice of classes that agrees best, which a method that knows nothing of skin is given.
/// Nothing when no point is a defect.
std::optional<double> DefectAgreement(const ColourClusters& clusters, const std::vector<std::uint8_t>& truth,
                                      bool first_is_skin);

}  // namespace drupe
