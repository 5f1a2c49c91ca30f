#include "defect_analysis/defects/segmentation.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>

namespace drupe {
namespace {

constexpr int kBins = 64;            // a side of the histogram
constexpr float kBinSize = 2.5f;     // weighted Lab units; the histogram reaches from -80 to 80
constexpr float kRareShare = 2e-5f;  // of all colours: rarer ones start no class

struct Bin {
  Eigen::Vector3f mean = Eigen::Vector3f::Zero();
  float count = 0;
  int label = 0;
};

int BinIndex(const Eigen::Vector3f& deviation) {
  int index = 0;
  for (int axis = 0; axis < 3; ++axis) {
    const int place = static_cast<int>(deviation[axis] / kBinSize + 0.5f * kBins);
    index = index * kBins + std::clamp(place, 0, kBins - 1);
  }
  return index;
}

// The occupied bins, and for each of the histogram's places which of them it is.
struct Histogram {
  std::vector<Bin> bins;
  std::vector<std::int32_t> bin_at;
  float total = 0;

  Histogram(const std::vector<Eigen::Vector3f>& deviations, const std::vector<std::uint8_t>& used)
      : bin_at(kBins * kBins * kBins, -1) {
    for (std::size_t i = 0; i < deviations.size(); ++i) {
      if (used[i] == 0) continue;
      std::int32_t& bin = bin_at[BinIndex(deviations[i])];
      if (bin < 0) {
        bin = static_cast<std::int32_t>(bins.size());
        bins.emplace_back();
      }
      bins[bin].mean += deviations[i];
      bins[bin].count += 1;
      total += 1;
    }
    for (Bin& bin : bins) bin.mean /= bin.count;
  }
};

// Maximum-minimum distance: zero first, then again and again the colour farthest from all centres.
std::vector<Eigen::Vector3f> InitialCentres(const Histogram& histogram, int count) {
  std::vector<Eigen::Vector3f> centres = {Eigen::Vector3f::Zero()};
  std::vector<float> distance(histogram.bins.size(), std::numeric_limits<float>::max());
  while (static_cast<int>(centres.size()) < count) {
    std::size_t farthest = 0;
    float largest = -1;
    for (std::size_t i = 0; i < histogram.bins.size(); ++i) {
      const Bin& bin = histogram.bins[i];
      distance[i] = std::min(distance[i], (bin.mean - centres.back()).squaredNorm());
      if (distance[i] <= largest || bin.count < kRareShare * histogram.total) continue;
      largest = distance[i];
      farthest = i;
    }
    if (largest <= 0) break;
    centres.push_back(histogram.bins[farthest].mean);
  }
  return centres;
}

// Lloyd's iterations over the bins; labels are left in them. An emptied class keeps its centre.
void RunKMeans(Histogram& histogram, std::vector<Eigen::Vector3f>& centres, int max_iterations) {
  for (int iteration = 0; iteration < max_iterations; ++iteration) {
    std::vector<Eigen::Vector4f> sums(centres.size(), Eigen::Vector4f::Zero());
    bool changed = iteration == 0;
    for (Bin& bin : histogram.bins) {
      const int label = NearestCentre(bin.mean, centres);
      changed |= label != bin.label;
      bin.label = label;
      sums[label].head<3>() += bin.count * bin.mean;
      sums[label][3] += bin.count;
    }
    if (!changed) return;
    for (std::size_t k = 0; k < centres.size(); ++k) {
      if (sums[k][3] > 0) centres[k] = sums[k].head<3>() / sums[k][3];
    }
  }
}

double DaviesBouldin(const Histogram& histogram, const std::vector<Eigen::Vector3f>& centres) {
  std::vector<double> spread(centres.size(), 0), count(centres.size(), 0);
  for (const Bin& bin : histogram.bins) {
    spread[bin.label] += bin.count * (bin.mean - centres[bin.label]).norm();
    count[bin.label] += bin.count;
  }
  for (std::size_t k = 0; k < centres.size(); ++k) spread[k] /= std::max(1.0, count[k]);
  double sum = 0;
  for (std::size_t a = 0; a < centres.size(); ++a) {
    double worst = 0;
    for (std::size_t b = 0; b < centres.size(); ++b) {
      if (a == b) continue;
      const double apart = std::max(1e-6f, (centres[a] - centres[b]).norm());
      worst = std::max(worst, (spread[a] + spread[b]) / apart);
    }
    sum += worst;
  }
  return sum / static_cast<double>(centres.size());
}

Eigen::Vector3f MeanBeyond(const Histogram& histogram, double threshold) {
  Eigen::Vector4f sum = Eigen::Vector4f::Zero();
  for (const Bin& bin : histogram.bins) {
    if (bin.mean.norm() > threshold) sum += bin.count * bin.mean.homogeneous();
  }
  return sum.hnormalized();
}

// Class of every bin after the test of significance: below the threshold a colour is healthy, whatever its class, and
// above it it belongs to the nearest significant class.
void TestSignificance(Histogram& histogram, std::vector<Eigen::Vector3f>& centres, double threshold) {
  std::vector<Eigen::Vector3f> kept = {centres[0]};
  for (std::size_t k = 1; k < centres.size(); ++k) {
    if (centres[k].norm() > threshold) kept.push_back(centres[k]);
  }
  if (kept.size() == 1) kept.push_back(MeanBeyond(histogram, threshold));
  const std::vector<Eigen::Vector3f> defects(kept.begin() + 1, kept.end());
  for (Bin& bin : histogram.bins) {
    bin.label = bin.mean.norm() > threshold ? 1 + NearestCentre(bin.mean, defects) : 0;
  }
  centres = std::move(kept);
}

}  // namespace

int NearestCentre(const Eigen::Vector3f& colour, const std::vector<Eigen::Vector3f>& centres) {
  int nearest = 0;
  float best = std::numeric_limits<float>::max();
  for (std::size_t k = 0; k < centres.size(); ++k) {
    const float distance = (colour - centres[k]).squaredNorm();
    if (distance < best) {
      best = distance;
      nearest = static_cast<int>(k);
    }
  }
  return nearest;
}

Segmentation SegmentColours(const std::vector<Eigen::Vector3f>& deviations, const std::vector<std::uint8_t>& used,
                            double sigma, const SegmentationOptions& options) {
  Histogram histogram(deviations, used);
  Segmentation result;
  result.threshold = std::max(options.significance_delta_e, options.significance_sigma * sigma);
  result.class_of.assign(deviations.size(), 0);
  result.centres = {Eigen::Vector3f::Zero()};
  const bool significant = std::any_of(histogram.bins.begin(), histogram.bins.end(),
                                       [&](const Bin& bin) { return bin.mean.norm() > result.threshold; });
  if (!significant) return result;
  result.davies_bouldin = std::numeric_limits<double>::max();
  for (int k = options.min_clusters; k <= options.max_clusters; ++k) {
    std::vector<Eigen::Vector3f> centres = InitialCentres(histogram, k);
    RunKMeans(histogram, centres, options.max_iterations);
    const double index = DaviesBouldin(histogram, centres);
    if (index >= result.davies_bouldin) continue;
    result.davies_bouldin = index;
    result.centres = centres;
  }
  TestSignificance(histogram, result.centres, result.threshold);
  for (std::size_t i = 0; i < deviations.size(); ++i) {
    if (used[i] == 0) continue;
    result.class_of[i] = static_cast<std::uint8_t>(histogram.bins[histogram.bin_at[BinIndex(deviations[i])]].label);
  }
  return result;
}

}  // namespace drupe
