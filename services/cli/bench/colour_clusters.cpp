#include "cli/bench/colour_clusters.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <opencv2/core.hpp>

#include "base/clock.h"
#include "defect_analysis/defects/segmentation.h"

namespace drupe {

namespace {

constexpr int kMaxIterations = 30;
constexpr double kTolerance = 0.01;  // weighted Lab units
constexpr int kSeed = 1;
constexpr int kMaxClasses = 16;

}  // namespace

ColourClusters ClusterByOpenCv(const std::vector<Eigen::Vector3f>& colours, int classes, bool spread_centres) {
  ColourClusters clusters{.colours = colours, .class_of = {}, .classes = classes};
  cv::Mat samples(static_cast<int>(colours.size()), 3, CV_32F);
  for (std::size_t i = 0; i < colours.size(); ++i) {
    std::copy_n(colours[i].data(), 3, samples.ptr<float>(static_cast<int>(i)));
  }
  cv::Mat labels;
  cv::setRNGSeed(kSeed);
  const Stopwatch watch;
  cv::kmeans(samples, classes, labels, {cv::TermCriteria::MAX_ITER + cv::TermCriteria::EPS, kMaxIterations, kTolerance},
             1, spread_centres ? cv::KMEANS_PP_CENTERS : cv::KMEANS_RANDOM_CENTERS);
  clusters.cpu_s = watch.CpuSeconds();
  for (std::size_t i = 0; i < colours.size(); ++i) {
    clusters.class_of.push_back(static_cast<std::uint8_t>(labels.at<int>(static_cast<int>(i))));
  }
  return clusters;
}

ColourClusters ClusterByNearest(const std::vector<Eigen::Vector3f>& colours,
                                const std::vector<Eigen::Vector3f>& centres) {
  ColourClusters clusters{.colours = colours, .class_of = {}, .classes = static_cast<int>(centres.size())};
  clusters.class_of.reserve(colours.size());
  for (const Eigen::Vector3f& colour : colours) {
    clusters.class_of.push_back(static_cast<std::uint8_t>(NearestCentre(colour, centres)));
  }
  return clusters;
}

std::optional<double> DaviesBouldinIndex(const ColourClusters& clusters) {
  std::vector<Eigen::Vector4d> sums(clusters.classes, Eigen::Vector4d::Zero());
  for (std::size_t i = 0; i < clusters.colours.size(); ++i) {
    sums[clusters.class_of[i]] += clusters.colours[i].cast<double>().homogeneous();
  }
  std::vector<double> spread(clusters.classes, 0);
  for (std::size_t i = 0; i < clusters.colours.size(); ++i) {
    const Eigen::Vector4d& sum = sums[clusters.class_of[i]];
    const Eigen::Vector3d centre = sum.head<3>() / sum[3];
    spread[clusters.class_of[i]] += (clusters.colours[i].cast<double>() - centre).norm() / sum[3];
  }
  double total = 0;
  int used = 0;
  for (int a = 0; a < clusters.classes; ++a) {
    if (sums[a][3] == 0) continue;
    ++used;
    double worst = 0;
    for (int b = 0; b < clusters.classes; ++b) {
      if (a == b || sums[b][3] == 0) continue;
      const double apart = (sums[a].hnormalized() - sums[b].hnormalized()).norm();
      worst = std::max(worst, (spread[a] + spread[b]) / std::max(1e-9, apart));
    }
    total += worst;
  }
  if (used < 2) return std::nullopt;
  return total / used;
}

std::optional<double> DefectAgreement(const ColourClusters& clusters, const std::vector<std::uint8_t>& truth,
                                      bool first_is_skin) {
  std::array<double, kMaxClasses> healthy{}, defect{};
  double defects = 0;
  for (std::size_t i = 0; i < truth.size(); ++i) {
    (truth[i] != 0 ? defect : healthy)[clusters.class_of[i]] += 1;
    defects += truth[i] != 0 ? 1 : 0;
  }
  if (defects == 0) return std::nullopt;
  double best = 0;
  const int choices = 1 << clusters.classes;
  for (int choice = first_is_skin ? choices - 2 : 1; choice < choices - (first_is_skin ? 1 : 0); ++choice) {
    double both = 0, either = defects;
    for (int k = 0; k < clusters.classes; ++k) {
      if ((choice >> k & 1) == 0) continue;
      both += defect[k];
      either += healthy[k];
    }
    best = std::max(best, both / either);
  }
  return best;
}

}  // namespace drupe
