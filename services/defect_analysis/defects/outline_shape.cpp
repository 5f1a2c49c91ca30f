#include "defect_analysis/defects/outline_shape.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <numeric>
#include <optional>

#include "defect_analysis/defects/corner_cut.h"
#include "defect_analysis/defects/round_outline.h"

namespace drupe {
namespace {

using std::numbers::pi;
constexpr double kNeck = 0.75;      // of the smaller part's half width
constexpr double kWideNeck = 0.87;  // the same between two parts that both are parts of discs
constexpr double kDiscRms = 0.035;  // of an outline about its smooth form, relative to its radius
constexpr double kLeastFill = 0.6;  // of a part's area against the disc of its half width
constexpr double kMostFill = 1.7;
constexpr int kNodesAcross = 48;  // of the watershed's grid, over the outline's square root of area
constexpr int kMaxGrid = 400;
constexpr std::size_t kOutlineSample = 240;

// A watershed of the distance to an outline, on a grid over it.
class Watershed {
 public:
  struct Neck {
    Eigen::Vector2d at = Eigen::Vector2d::Zero();
    double ratio = 1;                         // half width at the neck over that of the smaller part
    double small_width = 0, large_width = 0;  // half widths of the parts
  };

  explicit Watershed(const Polygon& outline) {
    Lay(outline);
    MeasureDistances(outline);
  }

  // The narrowest neck, taken over parts at least `least` wide (half width).
  Neck Narrowest(double least) {
    std::vector<int> order;
    for (int node = 0; node < static_cast<int>(distance_.size()); ++node) {
      if (distance_[node] > 0) order.push_back(node);
    }
    std::stable_sort(order.begin(), order.end(), [&](int a, int b) { return distance_[a] > distance_[b]; });
    parent_.assign(distance_.size(), -1);
    Neck best;
    for (const int node : order) Join(node, least, best);
    return best;
  }

 private:
  void Lay(const Polygon& outline) {
    Eigen::Vector2d low = outline.front(), high = low;
    for (const Eigen::Vector2d& p : outline) {
      low = low.cwiseMin(p);
      high = high.cwiseMax(p);
    }
    const Eigen::Vector2d size = high - low;
    step_ = std::max(std::sqrt(std::abs(SignedArea(outline))) / kNodesAcross, size.maxCoeff() / kMaxGrid);
    origin_ = low - Eigen::Vector2d::Constant(step_);
    width_ = static_cast<int>(size.x() / step_) + 3;
    height_ = static_cast<int>(size.y() / step_) + 3;
  }

  // Distance to the outline inside it, 0 outside; rows are filled between the outline's crossings.
  void MeasureDistances(const Polygon& outline) {
    distance_.assign(static_cast<std::size_t>(width_) * height_, 0);
    const std::size_t stride = std::max<std::size_t>(1, outline.size() / kOutlineSample);
    for (int row = 0; row < height_; ++row) {
      std::vector<double> crossings;
      const double y = origin_.y() + row * step_;
      for (std::size_t i = 0; i < outline.size(); ++i) {
        const Eigen::Vector2d &a = outline[i], &b = outline[(i + 1) % outline.size()];
        if ((a.y() > y) != (b.y() > y)) crossings.push_back(a.x() + (y - a.y()) / (b.y() - a.y()) * (b.x() - a.x()));
      }
      std::sort(crossings.begin(), crossings.end());
      for (std::size_t k = 0; k + 1 < crossings.size(); k += 2) {
        const int from = static_cast<int>(std::ceil((crossings[k] - origin_.x()) / step_));
        const int to = static_cast<int>(std::floor((crossings[k + 1] - origin_.x()) / step_));
        for (int column = from; column <= to; ++column) {
          const Eigen::Vector2d p(origin_.x() + column * step_, y);
          double nearest = 1e18;
          for (std::size_t i = 0; i < outline.size(); i += stride) {
            nearest = std::min(nearest, (outline[i] - p).squaredNorm());
          }
          distance_[row * width_ + column] = std::sqrt(nearest);
        }
      }
    }
  }

  int Root(int node) {
    while (parent_[node] != node) node = parent_[node] = parent_[parent_[node]];
    return node;
  }

  // Adds a node, highest first; where it joins two hills, their saddle is a neck. A hill's root is its peak.
  void Join(int node, double least, Neck& best) {
    parent_[node] = node;
    for (const int other : {node - width_ - 1, node - width_, node - width_ + 1, node - 1, node + 1, node + width_ - 1,
                            node + width_, node + width_ + 1}) {
      if (other < 0 || other >= static_cast<int>(parent_.size()) || parent_[other] < 0) continue;
      int high = Root(node), low = Root(other);
      if (high == low) continue;
      if (distance_[high] < distance_[low]) std::swap(high, low);
      const double ratio = distance_[node] / distance_[low];
      if (distance_[low] >= least && ratio < best.ratio) {
        best = {origin_ + step_ * Eigen::Vector2d(node % width_, node / width_), ratio, distance_[low],
                distance_[high]};
      }
      parent_[low] = high;
    }
  }

  double step_ = 1;
  Eigen::Vector2d origin_ = Eigen::Vector2d::Zero();
  int width_ = 0, height_ = 0;
  std::vector<double> distance_;
  std::vector<int> parent_;
};

// The outline's nearest points to the neck on either side of it.
std::pair<std::size_t, std::size_t> NeckEnds(const Polygon& outline, const Eigen::Vector2d& neck) {
  const auto nearest = [&](const auto& allowed) {
    std::size_t best = outline.size();
    for (std::size_t i = 0; i < outline.size(); ++i) {
      if (!allowed(outline[i] - neck)) continue;
      if (best == outline.size() || (outline[i] - neck).norm() < (outline[best] - neck).norm()) best = i;
    }
    return best;
  };
  const std::size_t first = nearest([](const Eigen::Vector2d&) { return true; });
  const Eigen::Vector2d away = (outline[first] - neck).normalized();
  const std::size_t second =
      nearest([&](const Eigen::Vector2d& offset) { return offset.dot(away) < -0.5 * offset.norm(); });
  return {std::min(first, second), std::max(first, second)};
}

bool FillsDisc(const Polygon& part, double half_width) {
  const double fill = std::abs(SignedArea(part)) / (pi * half_width * half_width);
  return fill > kLeastFill && fill < kMostFill;
}

// Whether a part follows a round outline so closely that a wide neck is no accident of its shape.
bool IsPartOfDisc(const std::optional<CompletedOutline>& part) {
  return part && part->rms < kDiscRms;
}

std::vector<Polygon> SplitFurther(const Polygon& first, const Polygon& second, double min_area) {
  std::vector<Polygon> split = SplitAtNeck(first, min_area);
  for (Polygon& piece : SplitAtNeck(second, min_area)) split.push_back(std::move(piece));
  return split;
}

}  // namespace

std::vector<Polygon> SplitAtNeck(const Polygon& outline, double min_area) {
  if (const auto parts = CutAtCorners(outline, min_area)) {
    return SplitFurther((*parts)[0].polygon, (*parts)[1].polygon, min_area);
  }
  const Watershed::Neck neck = Watershed(outline).Narrowest(0.8 * std::sqrt(min_area / pi));
  if (neck.ratio >= kWideNeck) return {outline};
  const auto [from, to] = NeckEnds(outline, neck.at);
  if (to >= outline.size() || to - from < 6 || outline.size() - (to - from) < 6) return {outline};
  const auto begin = outline.begin();
  std::vector<Polygon> parts = {
      Polygon(begin + static_cast<std::ptrdiff_t>(from), begin + static_cast<std::ptrdiff_t>(to)),
      Polygon(begin + static_cast<std::ptrdiff_t>(to), outline.end())};
  parts[1].insert(parts[1].end(), begin, begin + static_cast<std::ptrdiff_t>(from));
  const bool first_is_large = std::abs(SignedArea(parts[0])) >= std::abs(SignedArea(parts[1]));
  if (!FillsDisc(parts[0], first_is_large ? neck.large_width : neck.small_width) ||
      !FillsDisc(parts[1], first_is_large ? neck.small_width : neck.large_width)) {
    return {outline};
  }
  std::array<std::optional<CompletedOutline>, 2> rounds = {CompleteOutline(parts[0]), CompleteOutline(parts[1])};
  if (neck.ratio >= kNeck && !(IsPartOfDisc(rounds[0]) && IsPartOfDisc(rounds[1]))) return {outline};
  return SplitFurther(rounds[0] ? rounds[0]->polygon : parts[0], rounds[1] ? rounds[1]->polygon : parts[1], min_area);
}

}  // namespace drupe
