#include "cli/bench/dense_truth.h"

#include <pcl/kdtree/kdtree_flann.h>
#include <pcl/point_types.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <utility>

#include "base/files.h"
#include "scene/ply.h"

namespace drupe {

namespace {

constexpr double kFacing = 0.35;  ///< cosine of 70 degrees
constexpr int kLeastViews = 3;

/// One true fruit.
struct TrueSkin {
  Eigen::Vector3d centre = Eigen::Vector3d::Zero();
  std::vector<Eigen::Vector3d> skin;
  std::vector<int> facing;   ///< a sample: views that it faces
  std::vector<int> visible;  ///< of them those from which no fruit hides it
};

/// Nearest neighbours among points.
class Neighbours {
 public:
  explicit Neighbours(const std::vector<Eigen::Vector3d>& points) {
    auto cloud = std::make_shared<pcl::PointCloud<pcl::PointXYZ>>();
    for (const Eigen::Vector3d& p : points) cloud->push_back(ToPcl(p));
    tree_.setInputCloud(cloud);
  }

  /// Indices and distances of the nearest, nearest first.
  void Find(const Eigen::Vector3d& point, int count, std::vector<int>* indices, std::vector<float>* distances) const {
    tree_.nearestKSearch(ToPcl(point), count, *indices, *distances);
    for (float& distance : *distances) distance = std::sqrt(distance);
  }

 private:
  static pcl::PointXYZ ToPcl(const Eigen::Vector3d& p) {
    return {static_cast<float>(p.x()), static_cast<float>(p.y()), static_cast<float>(p.z())};
  }
  pcl::KdTreeFLANN<pcl::PointXYZ> tree_;
};

Result<std::vector<TrueSkin>> LoadFruits(const TruthSet& set) {
  DRUPE_ASSIGN_OR_RETURN(const std::string bytes, ReadFile(set.directory + "/surface.ply", std::size_t{256} << 20));
  DRUPE_ASSIGN_OR_RETURN(const PointCloud skin, ReadPly(bytes));
  const Json fruits = set.truth.contains("fruits") ? set.truth["fruits"] : Json::array({set.truth});
  std::vector<TrueSkin> result;
  try {
    for (const Json& json : fruits) {
      TrueSkin fruit;
      for (int axis = 0; axis < 3; ++axis) fruit.centre[axis] = json.at("centre_mm").at(axis).get<double>();
      std::size_t first = 0, end = skin.size();
      if (json.contains("surface_range")) {
        first = json["surface_range"].at(0).get<std::size_t>();
        end = std::min(end, json["surface_range"].at(1).get<std::size_t>());
      }
      for (std::size_t i = first; i < end; ++i) fruit.skin.push_back(skin.positions[i].cast<double>());
      if (fruit.skin.size() < 6)
        return InvalidArgument("bad_truth", "surface.ply has too few samples", "surface_range");
      result.push_back(std::move(fruit));
    }
  } catch (const std::exception& error) {
    return InvalidArgument("bad_truth", std::string("truth.json: fruits: ") + error.what(), "fruits");
  }
  return result;
}

/// The nearest depths of one view, in cells of its picture that are wide enough to hold several samples.
class DepthCells {
 public:
  DepthCells(const Rigid3& cam_from_world, double focal_px) : pose_(cam_from_world), focal_(focal_px) {}

  void Add(const Eigen::Vector3d& point) {
    double& nearest = nearest_.try_emplace(CellOf(point), std::numeric_limits<double>::max()).first->second;
    nearest = std::min(nearest, (pose_ * point).z());
  }
  bool Hides(const Eigen::Vector3d& point) const {
    constexpr double kClearlyBehind = 3;  // mm
    return (pose_ * point).z() > nearest_.at(CellOf(point)) + kClearlyBehind;
  }

 private:
  std::pair<int, int> CellOf(const Eigen::Vector3d& point) const {
    const Eigen::Vector3d in_cam = pose_ * point;
    return {static_cast<int>(std::floor(focal_ * in_cam.x() / in_cam.z())),
            static_cast<int>(std::floor(focal_ * in_cam.y() / in_cam.z()))};
  }
  Rigid3 pose_;
  double focal_;
  std::map<std::pair<int, int>, double> nearest_;
};

/// Fills `facing` and `visible`.
void CountViews(const TruthSet& set, std::vector<TrueSkin>* fruits) {
  constexpr double kCellsPerDistance = 250;  // cells of 0.4 % of the distance
  for (TrueSkin& fruit : *fruits) {
    fruit.facing.assign(fruit.skin.size(), 0);
    fruit.visible.assign(fruit.skin.size(), 0);
  }
  for (const TrueView& view : set.views) {
    DepthCells cells(view.cam_from_world, kCellsPerDistance);
    for (const TrueSkin& fruit : *fruits) {
      for (const Eigen::Vector3d& sample : fruit.skin) cells.Add(sample);
    }
    const Eigen::Vector3d centre = view.cam_from_world.Centre();
    for (TrueSkin& fruit : *fruits) {
      for (std::size_t i = 0; i < fruit.skin.size(); ++i) {
        const Eigen::Vector3d outward = (fruit.skin[i] - fruit.centre).normalized();
        if (outward.dot((centre - fruit.skin[i]).normalized()) <= kFacing) continue;
        ++fruit.facing[i];
        fruit.visible[i] += cells.Hides(fruit.skin[i]) ? 0 : 1;
      }
    }
  }
}

/// What all fruits of a set add to.
struct SkinTally {
  std::vector<double> errors, ratios;
  std::size_t faced = 0, faced_010 = 0, faced_020 = 0;
  std::size_t visible = 0, visible_010 = 0, visible_020 = 0;
};

double ReachOf(const TrueSkin& fruit) {
  constexpr double kBeyond = 1.5;
  double reach = 0;
  for (const Eigen::Vector3d& sample : fruit.skin) reach = std::max(reach, (sample - fruit.centre).norm());
  return reach + kBeyond;
}

double RadialError(const TrueSkin& fruit, const Neighbours& skin, const Eigen::Vector3d& point) {
  std::vector<int> indices;
  std::vector<float> distances;
  skin.Find(point, 6, &indices, &distances);
  double radius = 0, weights = 0;
  for (std::size_t k = 0; k < indices.size(); ++k) {
    const double weight = 1 / (distances[k] + 1e-6);
    radius += weight * (fruit.skin[indices[k]] - fruit.centre).norm();
    weights += weight;
  }
  return std::abs((point - fruit.centre).norm() - radius / weights);
}

void TallyErrors(const TrueSkin& fruit, const std::vector<Eigen::Vector3d>& points, const std::vector<float>& expected,
                 SkinTally* tally) {
  const Neighbours skin(fruit.skin);
  for (std::size_t i = 0; i < points.size(); ++i) {
    tally->errors.push_back(RadialError(fruit, skin, points[i]));
    if (!expected.empty() && expected[i] > 0) tally->ratios.push_back(tally->errors.back() / expected[i]);
  }
}

void TallyCompleteness(const TrueSkin& fruit, const std::vector<Eigen::Vector3d>& points, SkinTally* tally) {
  const Neighbours cloud(points.empty() ? std::vector<Eigen::Vector3d>{{1e6, 1e6, 1e6}} : points);
  std::vector<int> indices;
  std::vector<float> distances;
  for (std::size_t i = 0; i < fruit.skin.size(); ++i) {
    if (fruit.facing[i] < kLeastViews) continue;
    cloud.Find(fruit.skin[i], 1, &indices, &distances);
    const bool near_010 = distances[0] < 0.10f, near_020 = distances[0] < 0.20f;
    ++tally->faced;
    tally->faced_010 += near_010;
    tally->faced_020 += near_020;
    if (fruit.visible[i] < kLeastViews) continue;
    ++tally->visible;
    tally->visible_010 += near_010;
    tally->visible_020 += near_020;
  }
}

double Percentile(std::vector<double>* values, double share) {
  if (values->empty()) return 0;
  const auto at = values->begin() + static_cast<std::ptrdiff_t>(share * static_cast<double>(values->size() - 1));
  std::nth_element(values->begin(), at, values->end());
  return *at;
}

double Percent(std::size_t part, std::size_t whole) {
  return whole == 0 ? 0 : 100.0 * static_cast<double>(part) / static_cast<double>(whole);
}

DenseErrors Summarise(std::size_t points, SkinTally* tally) {
  DenseErrors errors;
  errors.points = points;
  errors.on_fruit = tally->errors.size();
  errors.over_03_pct = Percent(static_cast<std::size_t>(std::count_if(tally->errors.begin(), tally->errors.end(),
                                                                      [](double e) { return e > 0.3; })),
                               tally->errors.size());
  errors.median = Percentile(&tally->errors, 0.5);
  errors.p95 = Percentile(&tally->errors, 0.95);
  errors.complete_010_pct = Percent(tally->faced_010, tally->faced);
  errors.complete_020_pct = Percent(tally->faced_020, tally->faced);
  errors.visible_010_pct = Percent(tally->visible_010, tally->visible);
  errors.visible_020_pct = Percent(tally->visible_020, tally->visible);
  errors.error_over_expected = Percentile(&tally->ratios, 0.683);
  return errors;
}

}  // namespace

Result<DenseErrors> CompareCloud(const TruthSet& set, const PointCloud& cloud, const Sim3& truth_from_cloud) {
  DRUPE_ASSIGN_OR_RETURN(std::vector<TrueSkin> fruits, LoadFruits(set));
  CountViews(set, &fruits);
  std::vector<Eigen::Vector3d> aligned;
  for (const Eigen::Vector3f& position : cloud.positions) aligned.push_back(truth_from_cloud * position.cast<double>());
  SkinTally tally;
  for (const TrueSkin& fruit : fruits) {
    const double reach = ReachOf(fruit);
    std::vector<Eigen::Vector3d> points;
    std::vector<float> expected;
    for (std::size_t i = 0; i < aligned.size(); ++i) {
      if ((aligned[i] - fruit.centre).norm() >= reach) continue;
      points.push_back(aligned[i]);
      if (!cloud.expected_error.empty()) {
        expected.push_back(cloud.expected_error[i] * static_cast<float>(truth_from_cloud.scale));
      }
    }
    TallyErrors(fruit, points, expected, &tally);
    TallyCompleteness(fruit, points, &tally);
  }
  return Summarise(cloud.size(), &tally);
}

}  // namespace drupe
