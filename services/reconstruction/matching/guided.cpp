#include "reconstruction/matching/guided.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <numeric>
#include <optional>

#include "scene/descriptor_distance.h"

namespace drupe {
namespace {

/// The part of an epipolar line between the two depths.
struct Segment {
  Eigen::Vector2d from, to;
};

/// Nothing when a part of it lies behind the second camera.
std::optional<Segment> SegmentOf(const Eigen::Vector2d& place, const EpipolarTransfer& transfer,
                                 const GuidedOptions& options) {
  const Eigen::Vector3d ray = transfer.at_infinity * place.homogeneous();
  const Eigen::Vector3d far = ray + options.inverse_depth_min * transfer.epipole;
  const Eigen::Vector3d near = ray + options.inverse_depth_max * transfer.epipole;
  if (far.z() < 1e-3 || near.z() < 1e-3) return std::nullopt;
  return Segment{far.hnormalized(), near.hnormalized()};
}

/// Half-planes that end in the baseline, by their angle about it. A surface point and both its pictures lie in one.
class BaselinePencil {
 public:
  /// Angle 0 lies towards `middle`, so that the end of the circle is far from what is looked at.
  BaselinePencil(const Eigen::Vector3d& baseline, const Eigen::Vector3d& middle) : axis_(baseline) {
    across_ = middle - middle.dot(axis_) * axis_;
    across_ = across_.norm() > 1e-9 ? across_.normalized() : axis_.unitOrthogonal();
    third_ = axis_.cross(across_);
  }

  double AngleOf(const Eigen::Vector3d& ray) const { return std::atan2(ray.dot(third_), ray.dot(across_)); }

  /// How far a place within `radius` of the segment can be turned against it.
  double Reach(const Segment& segment, double radius) const {
    const double nearest = std::min(axis_.cross(segment.from.homogeneous()).squaredNorm(),
                                    axis_.cross(segment.to.homogeneous()).squaredNorm());
    return radius * radius < nearest ? std::asin(radius / std::sqrt(nearest)) : std::numbers::pi;
  }

 private:
  Eigen::Vector3d axis_, across_, third_;
};

/// Features of a picture in the order of their half-planes, so that those near an epipolar line are neighbours.
class PencilOrder {
 public:
  /// The rays of `places` are brought into the frame of the pencil by `into`.
  PencilOrder(const std::vector<Eigen::Vector2d>& places, const Eigen::Matrix3d& into, const BaselinePencil& pencil) {
    std::vector<double> angles;
    for (const Eigen::Vector2d& place : places) angles.push_back(pencil.AngleOf(into * place.homogeneous()));
    order_.resize(places.size());
    std::iota(order_.begin(), order_.end(), 0u);
    std::sort(order_.begin(), order_.end(),
              [&](std::uint32_t a, std::uint32_t b) { return angles[a] != angles[b] ? angles[a] < angles[b] : a < b; });
    for (const std::uint32_t i : order_) {
      angles_.push_back(angles[i]);
      places_.push_back(places[i]);
    }
  }

  std::size_t size() const { return order_.size(); }
  std::uint32_t Index(std::size_t rank) const { return order_[rank]; }
  double Angle(std::size_t rank) const { return angles_[rank]; }
  const Eigen::Vector2d& Place(std::size_t rank) const { return places_[rank]; }

  /// Calls visit(rank) for all whose half-plane is turned against `angle` by `reach` at most.
  template <typename Visit>
  void VisitAround(double angle, double reach, const Visit& visit) const {
    if (reach >= std::numbers::pi) return VisitRange(-4, 4, visit);
    constexpr double kTurn = 2 * std::numbers::pi;
    VisitRange(angle - reach, angle + reach, visit);
    if (angle - reach < -std::numbers::pi) VisitRange(angle - reach + kTurn, kTurn, visit);
    if (angle + reach > std::numbers::pi) VisitRange(-kTurn, angle + reach - kTurn, visit);
  }

 private:
  template <typename Visit>
  void VisitRange(double low, double high, const Visit& visit) const {
    const auto first = std::lower_bound(angles_.begin(), angles_.end(), low) - angles_.begin();
    for (std::size_t rank = first; rank < angles_.size() && angles_[rank] <= high; ++rank) visit(rank);
  }

  std::vector<std::uint32_t> order_;
  std::vector<double> angles_;           ///< ascending
  std::vector<Eigen::Vector2d> places_;  ///< in the same order
};

/// Whether a place lies within a radius of a segment, its ends included.
class SegmentTest {
 public:
  SegmentTest(const Segment& segment, double radius)
      : from_(segment.from), length_((segment.to - segment.from).norm()), radius_(radius) {
    unit_ = length_ > 0 ? Eigen::Vector2d((segment.to - segment.from) / length_) : Eigen::Vector2d::UnitX();
  }

  bool IsNear(const Eigen::Vector2d& place) const {
    const Eigen::Vector2d offset = place - from_;
    const double along = offset.dot(unit_), across = offset.x() * unit_.y() - offset.y() * unit_.x();
    return std::abs(across) <= radius_ && along >= -radius_ && along < length_ + radius_;
  }

 private:
  Eigen::Vector2d from_, unit_;
  double length_, radius_;
};

/// The best partner so far of a feature.
struct Partner {
  std::uint32_t index = 0;
  std::int32_t distance = std::numeric_limits<std::int32_t>::max();
  std::int32_t second = std::numeric_limits<std::int32_t>::max();

  void Offer(std::uint32_t candidate, std::int32_t squared_distance) {
    if (squared_distance < distance) {
      second = distance;
      distance = squared_distance;
      index = candidate;
    } else {
      second = std::min(second, squared_distance);
    }
  }
  bool Passes(const GuidedOptions& options) const {
    return distance <= options.max_squared_distance && distance < options.max_ratio * options.max_ratio * second;
  }
};

Eigen::Vector3d MeanRay(const std::vector<Eigen::Vector2d>& places) {
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  for (const Eigen::Vector2d& place : places) sum += place.homogeneous();
  return sum.normalized();
}

}  // namespace

std::vector<FeatureMatch> MatchGuided(const PreparedPicture& first, const PreparedPicture& second,
                                      const EpipolarTransfer& transfer, const GuidedOptions& options) {
  if (second.kept.empty()) return {};
  const BaselinePencil pencil(transfer.epipole, MeanRay(second.places));
  const PencilOrder from(first.places, transfer.at_infinity, pencil);
  const PencilOrder to(second.places, Eigen::Matrix3d::Identity(), pencil);
  std::vector<Partner> forward(first.kept.size()), backward(second.kept.size());
  for (std::size_t rank = 0; rank < from.size(); ++rank) {
    const std::optional<Segment> segment = SegmentOf(from.Place(rank), transfer, options);
    if (!segment) continue;
    const SegmentTest test(*segment, options.max_error);
    const std::uint32_t i = from.Index(rank);
    to.VisitAround(from.Angle(rank), pencil.Reach(*segment, options.max_error), [&](std::size_t candidate) {
      if (!test.IsNear(to.Place(candidate))) return;
      const std::uint32_t j = to.Index(candidate);
      const std::int32_t distance = SquaredDistance(first.Descriptor(i), second.Descriptor(j));
      forward[i].Offer(j, distance);
      backward[j].Offer(i, distance);
    });
  }
  std::vector<FeatureMatch> matches;
  for (std::uint32_t i = 0; i < forward.size(); ++i) {
    const Partner& partner = forward[i];
    if (partner.Passes(options) && backward[partner.index].index == i) matches.push_back({i, partner.index});
  }
  return matches;
}

}  // namespace drupe
