#include "defect_analysis/defects/local_halfway.h"

#include <algorithm>
#include <cmath>
#include <optional>

namespace drupe {
namespace {

constexpr double kOuterFrom = 0.35, kOuterTo = 0.6;  // mm outside the outline
constexpr double kMostInner = 1.0;                   // mm inside
constexpr double kAlong = 0.5;                       // mm of outline, either way, over which levels are averaged
constexpr double kMostMove = 0.35;                   // mm
constexpr double kLeastStep = 0.35;                  // between inside and outside, for a middle to be sought
constexpr int kSamples = 5;
constexpr int kIterations = 2;

class Follower {
 public:
  Follower(const TransitionField& field, double share) : field_(field), share_(share) {}

  Polygon Move(const Polygon& outline) const {
    const auto window = static_cast<int>(std::ceil(kAlong / std::max(1e-6, LengthOf(outline)) * outline.size()));
    const std::vector<Eigen::Vector2d> normals = Normals(outline);
    const double depth = std::min(kMostInner, SignedArea(outline) / LengthOf(outline));
    std::vector<double> inner, outer;
    for (std::size_t i = 0; i < outline.size(); ++i) {
      inner.push_back(MeanAlong(outline[i], -normals[i], 0.6 * depth, depth).value_or(1));
      outer.push_back(MeanAlong(outline[i], normals[i], kOuterFrom, kOuterTo).value_or(0));
    }
    inner = Smoothed(inner, window);
    outer = Smoothed(outer, window);
    std::vector<double> moves;
    for (std::size_t i = 0; i < outline.size(); ++i) {
      const bool clear = inner[i] - outer[i] >= kLeastStep;
      moves.push_back(clear ? MoveTo(outline[i], normals[i], outer[i] + share_ * (inner[i] - outer[i])) : 0);
    }
    moves = Smoothed(moves, std::max(1, window / 5));
    Polygon moved;
    for (std::size_t i = 0; i < outline.size(); ++i) moved.push_back(outline[i] + moves[i] * normals[i]);
    return moved;
  }

 private:
  static double LengthOf(const Polygon& outline) {
    double length = 0;
    for (std::size_t i = 0; i < outline.size(); ++i) length += (outline[(i + 1) % outline.size()] - outline[i]).norm();
    return length;
  }

  // Outward for a counter-clockwise outline, from the chord over about four of the kernel's widths.
  std::vector<Eigen::Vector2d> Normals(const Polygon& outline) const {
    const std::size_t count = outline.size();
    const double spacing = LengthOf(outline) / static_cast<double>(count);
    const std::size_t reach =
        std::clamp<std::size_t>(static_cast<std::size_t>(2 * field_.blur / spacing), 1, count / 8 + 1);
    std::vector<Eigen::Vector2d> normals;
    for (std::size_t i = 0; i < count; ++i) {
      const Eigen::Vector2d chord = outline[(i + reach) % count] - outline[(i + count - reach) % count];
      normals.push_back(Eigen::Vector2d(chord.y(), -chord.x()).normalized());
    }
    return normals;
  }

  // The level before the reach's limit at a place; nothing outside the grid or in another defect.
  std::optional<double> LevelAt(const Eigen::Vector2d& flat) const {
    const Eigen::Vector2d place = (flat - field_.origin) / field_.step;
    const int column = static_cast<int>(std::floor(place.x())), row = static_cast<int>(std::floor(place.y()));
    if (column < 0 || row < 0 || column + 1 >= field_.width || row + 1 >= field_.height) return std::nullopt;
    const std::size_t node = static_cast<std::size_t>(row) * field_.width + column;
    if (field_.inside[node] < 0) return std::nullopt;
    return field_.ValueAt(field_.full_level, flat);
  }

  std::optional<double> MeanAlong(const Eigen::Vector2d& from, const Eigen::Vector2d& direction, double near,
                                  double far) const {
    double sum = 0;
    int count = 0;
    for (int k = 0; k < kSamples; ++k) {
      const double at = near + (far - near) * k / (kSamples - 1);
      if (const auto level = LevelAt(from + at * direction)) {
        sum += std::clamp(*level, -0.2, 1.4);
        ++count;
      }
    }
    return count > 0 ? std::optional(sum / count) : std::nullopt;
  }

  static std::vector<double> Smoothed(const std::vector<double>& values, int window) {
    const int count = static_cast<int>(values.size());
    const int reach = std::min(window, (count - 1) / 2);
    std::vector<double> smooth(values.size());
    double sum = 0;
    for (int k = -reach; k <= reach; ++k) sum += values[(k + count) % count];
    for (int i = 0; i < count; ++i) {
      smooth[i] = sum / (2 * reach + 1);
      sum += values[(i + reach + 1) % count] - values[(i - reach + count) % count];
    }
    return smooth;
  }

  // How far along the normal the level passes `target`, nearest first; 0 when it does not.
  double MoveTo(const Eigen::Vector2d& from, const Eigen::Vector2d& normal, double target) const {
    const double step = field_.step / 2;
    double best = 0, nearest = kMostMove;
    std::optional<double> before;
    for (double at = -kMostMove; at <= kMostMove; at += step) {
      const auto level = LevelAt(from + at * normal);
      if (before && level && *before >= target && *level < target) {
        const double crossing = at - step * (target - *level) / std::max(1e-6, *before - *level);
        if (std::abs(crossing) < nearest) {
          nearest = std::abs(crossing);
          best = crossing;
        }
      }
      before = level;
    }
    return best;
  }

  const TransitionField& field_;
  double share_;
};

}  // namespace

Polygon FollowLocalHalfway(const TransitionField& field, const Polygon& outline, double level) {
  const Follower follower(field, level);
  Polygon moved = outline;
  for (int k = 0; k < kIterations && moved.size() >= 8; ++k) moved = follower.Move(moved);
  return SignedArea(moved) > 0.5 * SignedArea(outline) ? moved : outline;
}

}  // namespace drupe
