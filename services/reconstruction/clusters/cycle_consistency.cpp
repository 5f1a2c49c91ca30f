#include "reconstruction/clusters/cycle_consistency.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>

#include "reconstruction/clusters/rotation_averaging.h"

namespace drupe {
namespace {

constexpr double kDegree = std::numbers::pi / 180;
/// A pair of which no triplet closes has this share of the trust of one of which all do.
constexpr double kLeastTrust = 0.01;

/// Three edges (places in a list of pairs) among images a < b < c.
struct Triplet {
  int ab, bc, ac;
};

/// What the triplets say of one pair.
struct Votes {
  int agree = 0;
  int disagree = 0;
  bool AreAgainst() const { return disagree > agree; }
  double Trust() const {
    const int all = agree + disagree;
    return all == 0 ? 0.5 : kLeastTrust + (1 - kLeastTrust) * agree / all;
  }
};

/// All triplets of pairs; `pairs` ascending by (first, second).
std::vector<Triplet> FindTriplets(int image_count, const std::vector<const TwoViewMatches*>& pairs) {
  std::vector<std::vector<std::pair<int, int>>> later(image_count);  // per image: (later image, pair), ascending
  for (std::size_t p = 0; p < pairs.size(); ++p) {
    later[pairs[p]->pair.first].emplace_back(pairs[p]->pair.second, static_cast<int>(p));
  }
  std::vector<Triplet> triplets;
  for (int a = 0; a < image_count; ++a) {
    for (const auto& [b, ab] : later[a]) {
      for (const auto& [c, bc] : later[b]) {
        const auto ac = std::lower_bound(later[a].begin(), later[a].end(), std::pair(c, 0));
        if (ac != later[a].end() && ac->first == c) triplets.push_back({ab, bc, ac->second});
      }
    }
  }
  return triplets;
}

double AngleOf(const Eigen::Matrix3d& rotation) {
  return Eigen::AngleAxisd(rotation).angle();
}

void Vote(bool agrees, const Triplet& triplet, std::vector<Votes>& votes) {
  for (const int pair : {triplet.ab, triplet.bc, triplet.ac}) ++(agrees ? votes[pair].agree : votes[pair].disagree);
}

std::vector<Votes> VoteOnRotations(const std::vector<const TwoViewMatches*>& pairs,
                                   const std::vector<Triplet>& triplets, double max_cycle_rad) {
  std::vector<Votes> votes(pairs.size());
  for (const Triplet& triplet : triplets) {
    const auto rotation = [&pairs](int p) -> const Eigen::Matrix3d& { return pairs[p]->second_from_first.rotation; };
    const Eigen::Matrix3d cycle = rotation(triplet.ac).transpose() * rotation(triplet.bc) * rotation(triplet.ab);
    Vote(AngleOf(cycle) <= max_cycle_rad, triplet, votes);
  }
  return votes;
}

std::vector<RelativeRotation> Measured(const std::vector<const TwoViewMatches*>& pairs,
                                       const std::vector<Votes>& votes) {
  std::vector<RelativeRotation> measured;
  for (std::size_t p = 0; p < pairs.size(); ++p) {
    const double weight = votes[p].Trust() * static_cast<double>(pairs[p]->matches.size());
    measured.push_back(
        {pairs[p]->pair.first, pairs[p]->pair.second, pairs[p]->second_from_first.rotation, std::max(1e-3, weight)});
  }
  return measured;
}

double AngleBetween(const Eigen::Vector3d& a, const Eigen::Vector3d& b) {
  return std::atan2(a.cross(b).norm(), a.dot(b));
}

/// How far `direction` is from the nearest direction between a and b; all unit.
double DistanceToArc(const Eigen::Vector3d& direction, const Eigen::Vector3d& a, const Eigen::Vector3d& b) {
  const Eigen::Vector3d normal = a.cross(b);
  const bool is_between = a.cross(direction).dot(normal) > 0 && direction.cross(b).dot(normal) > 0;
  if (is_between) return std::asin(std::min(1.0, std::abs(direction.dot(normal.normalized()))));
  return std::min(AngleBetween(direction, a), AngleBetween(direction, b));
}

/// Directions from the first to the second camera of every pair, in the frame of the averaged rotations.
std::vector<Eigen::Vector3d> WorldDirections(const std::vector<const TwoViewMatches*>& pairs,
                                             const std::vector<Eigen::Matrix3d>& rotations) {
  std::vector<Eigen::Vector3d> directions;
  for (const TwoViewMatches* pair : pairs) {
    directions.push_back(
        -(rotations[pair->pair.second].transpose() * pair->second_from_first.translation).normalized());
  }
  return directions;
}

std::vector<Votes> VoteOnDirections(const std::vector<Eigen::Vector3d>& directions,
                                    const std::vector<Triplet>& triplets, double max_rad) {
  std::vector<Votes> votes(directions.size());
  for (const Triplet& triplet : triplets) {
    const Eigen::Vector3d &ab = directions[triplet.ab], &bc = directions[triplet.bc];
    // a to c lies between a to b and b to c; where those are opposite, the triangle is a needle that says nothing.
    if (AngleBetween(ab, -bc) < max_rad) continue;
    const double miss = DistanceToArc(directions[triplet.ac], ab, bc);
    Vote(miss <= max_rad, triplet, votes);
  }
  return votes;
}

/// Removes from the graph the pairs that `is_wrong` marks and returns the others; one mark for each of `pairs`.
void Drop(const std::vector<const TwoViewMatches*>& pairs, const std::vector<std::uint8_t>& is_wrong, MatchGraph& graph,
          CycleReport& report) {
  std::vector<std::uint8_t> drops(graph.pairs.size(), 0);
  for (std::size_t p = 0; p < pairs.size(); ++p) {
    if (!is_wrong[p]) continue;
    drops[pairs[p] - graph.pairs.data()] = 1;
    report.dropped.push_back(pairs[p]->pair);
  }
  std::size_t kept = 0;
  for (std::size_t i = 0; i < drops.size(); ++i) {
    if (drops[i]) continue;
    if (kept != i) graph.pairs[kept] = std::move(graph.pairs[i]);
    ++kept;
  }
  graph.pairs.resize(kept);
}

std::vector<const TwoViewMatches*> PairsWithPose(const MatchGraph& graph) {
  std::vector<const TwoViewMatches*> pairs;
  for (const TwoViewMatches& pair : graph.pairs) {
    if (pair.calibrated) pairs.push_back(&pair);
  }
  return pairs;
}

/// Drops pairs whose rotation disagrees; gives the averaged rotations.
std::vector<Eigen::Matrix3d> DropByRotation(int image_count, const CycleOptions& options, MatchGraph& graph,
                                            CycleReport& report) {
  const std::vector<const TwoViewMatches*> pairs = PairsWithPose(graph);
  const std::vector<Triplet> triplets = FindTriplets(image_count, pairs);
  report.triplets = static_cast<int>(triplets.size());
  const double bound = options.max_rotation_deg * kDegree;
  const std::vector<Votes> votes = VoteOnRotations(pairs, triplets, std::sqrt(3.0) * bound);
  const std::vector<RelativeRotation> measured = Measured(pairs, votes);
  const std::vector<Eigen::Matrix3d> rotations = AverageRotations(image_count, measured, 0.5 * bound);
  std::vector<std::uint8_t> is_wrong;
  for (const RelativeRotation& m : measured) is_wrong.push_back(RotationResidual(m, rotations) > bound ? 1 : 0);
  Drop(pairs, is_wrong, graph, report);
  return rotations;
}

void DropByDirection(int image_count, const CycleOptions& options, const std::vector<Eigen::Matrix3d>& rotations,
                     MatchGraph& graph, CycleReport& report) {
  const std::vector<const TwoViewMatches*> pairs = PairsWithPose(graph);
  const std::vector<Triplet> triplets = FindTriplets(image_count, pairs);
  const std::vector<Votes> votes =
      VoteOnDirections(WorldDirections(pairs, rotations), triplets, options.max_direction_deg * kDegree);
  std::vector<std::uint8_t> is_wrong;
  for (const Votes& vote : votes) is_wrong.push_back(vote.AreAgainst() ? 1 : 0);
  Drop(pairs, is_wrong, graph, report);
}

Status CheckPairs(int image_count, const MatchGraph& graph) {
  const TwoViewMatches* last = nullptr;
  for (const TwoViewMatches& pair : graph.pairs) {
    const auto [first, second] = pair.pair;
    const bool ascends = last == nullptr || std::pair(last->pair.first, last->pair.second) < std::pair(first, second);
    if (first < 0 || first >= second || second >= image_count || !ascends) {
      return InvalidArgument("invalid_pair", "the verified pairs must be ascending, of pictures of the set");
    }
    last = &pair;
  }
  return Status::Ok();
}

}  // namespace

Status CycleOptions::Check() const {
  if (!(max_rotation_deg >= 1 && max_rotation_deg <= 180)) {
    return InvalidArgument("invalid_option", "max_rotation_deg must be 1 to 180", "max_rotation_deg");
  }
  if (!(max_direction_deg >= 1 && max_direction_deg <= 180)) {
    return InvalidArgument("invalid_option", "max_direction_deg must be 1 to 180", "max_direction_deg");
  }
  return Status::Ok();
}

Result<CycleReport> DropInconsistentPairs(int image_count, const CycleOptions& options, MatchGraph& graph) {
  DRUPE_RETURN_IF_ERROR(options.Check());
  DRUPE_RETURN_IF_ERROR(CheckPairs(image_count, graph));
  CycleReport report;
  const std::vector<Eigen::Matrix3d> rotations = DropByRotation(image_count, options, graph, report);
  DropByDirection(image_count, options, rotations, graph, report);
  std::sort(report.dropped.begin(), report.dropped.end(), [](const ImagePair& a, const ImagePair& b) {
    return std::pair(a.first, a.second) < std::pair(b.first, b.second);
  });
  return report;
}

}  // namespace drupe
