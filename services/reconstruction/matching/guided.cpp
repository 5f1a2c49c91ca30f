#include "reconstruction/matching/guided.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

namespace drupe {
namespace {

/// The part of an epipolar line between the two depths.
struct Segment {
  Eigen::Vector2d from, to;
};

/// Nothing when a part of it lies behind the second camera.
std::optional<Segment> SegmentOf(const Eigen::Vector2d& place, const Rigid3& second_from_first,
                                 const GuidedOptions& options) {
  const Eigen::Vector3d ray = second_from_first.rotation * place.homogeneous();
  const Eigen::Vector3d far = ray + options.inverse_depth_min * second_from_first.translation;
  const Eigen::Vector3d near = ray + options.inverse_depth_max * second_from_first.translation;
  if (far.z() < 1e-3 || near.z() < 1e-3) return std::nullopt;
  return Segment{far.hnormalized(), near.hnormalized()};
}

/// Calls visit(index) for every point of the picture within `radius` of the segment, which is walked in steps of about
/// the radius' size times `kStep` so that the boxes stay close to it.
template <typename Visit>
void VisitNear(const PreparedPicture& picture, const Segment& segment, double radius, const Visit& visit) {
  constexpr double kStep = 8;
  constexpr int kMaxSteps = 512;
  const Eigen::Vector2d along = segment.to - segment.from;
  const double length = along.norm();
  const Eigen::Vector2d unit = length > 0 ? Eigen::Vector2d(along / length) : Eigen::Vector2d::UnitX();
  const int steps = std::clamp(static_cast<int>(length / (kStep * radius)), 1, kMaxSteps);
  for (int s = 0; s < steps; ++s) {
    const double begin = length * s / steps, end = length * (s + 1) / steps;
    const Eigen::Vector2d a = segment.from + begin * unit, b = segment.from + end * unit;
    const Eigen::Vector2f low = (a.cwiseMin(b).array() - radius).cast<float>();
    const Eigen::Vector2f high = (a.cwiseMax(b).array() + radius).cast<float>();
    picture.grid.VisitBox(low, high, [&](std::uint32_t i) {
      const Eigen::Vector2d offset = picture.places[i] - segment.from;
      const double position = offset.dot(unit);
      const double before = s == 0 ? -radius : begin, after = s + 1 == steps ? length + radius : end;
      const double across = std::abs(offset.x() * unit.y() - offset.y() * unit.x());
      if (across <= radius && position >= before && position < after) visit(i);
    });
  }
}

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

}  // namespace

std::vector<FeatureMatch> MatchGuided(const PreparedPicture& first, const PreparedPicture& second,
                                      const Rigid3& second_from_first, const GuidedOptions& options) {
  std::vector<Partner> forward(first.kept.size()), backward(second.kept.size());
  for (std::uint32_t i = 0; i < first.kept.size(); ++i) {
    const std::optional<Segment> segment = SegmentOf(first.places[i], second_from_first, options);
    if (!segment) continue;
    VisitNear(second, *segment, options.max_error, [&](std::uint32_t j) {
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
