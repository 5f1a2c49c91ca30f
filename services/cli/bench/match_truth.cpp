#include "cli/bench/match_truth.h"

#include <Eigen/Dense>
#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <filesystem>
#include <limits>

#include "base/files.h"
#include "scene/ply.h"

namespace drupe {

namespace {

constexpr int kCellsAcross = 160;  ///< cells along a picture's width
constexpr float kLayerMm = 2;      ///< points of a neighbourhood this far behind the nearest are of its front
constexpr std::size_t kMinPoints = 6;
constexpr double kMaxResidualMm = 0.3;  ///< of the plane through them; beyond, the surface is seen from the side

/// The plane depth = a x + b y + c through points, at a pixel; nothing when they do not lie in one.
std::optional<double> PlaneDepth(const std::vector<Eigen::Vector3f>& points, const Eigen::Vector2d& pixel) {
  Eigen::MatrixX3d rows(points.size(), 3);
  Eigen::VectorXd depths(points.size());
  for (std::size_t i = 0; i < points.size(); ++i) {
    const auto row = static_cast<Eigen::Index>(i);
    rows.row(row) << points[i].x() - pixel.x(), points[i].y() - pixel.y(), 1;
    depths[row] = points[i].z();
  }
  const Eigen::Vector3d plane = rows.colPivHouseholderQr().solve(depths);
  const double residual = std::sqrt((rows * plane - depths).squaredNorm() / static_cast<double>(points.size()));
  if (!plane.allFinite() || residual > kMaxResidualMm) return std::nullopt;
  return plane[2];
}

int CellPx(const PinholeCamera& camera) {
  return std::max(4, camera.width / kCellsAcross);
}

}  // namespace

Result<MatchTruth> MatchTruth::Load(const TruthSet& set) {
  MatchTruth truth(set);
  const std::string path = set.directory + "/surface.ply";
  if (!std::filesystem::exists(path)) return truth;
  DRUPE_ASSIGN_OR_RETURN(const std::string bytes, ReadFile(path));
  DRUPE_ASSIGN_OR_RETURN(const PointCloud surface, ReadPly(bytes));
  for (const TrueView& view : set.views) truth.AddLayer(view.cam_from_world, surface.positions);
  return truth;
}

void MatchTruth::AddLayer(const Rigid3& cam_from_world, const std::vector<Eigen::Vector3f>& surface) {
  const PinholeCamera& camera = set_->input.calibration->camera;
  const int cell = CellPx(camera);
  Layer layer;
  layer.columns = camera.width / cell + 1;
  layer.cells.resize(static_cast<std::size_t>(layer.columns) * (camera.height / cell + 1));
  for (const Eigen::Vector3f& point : surface) {
    const Eigen::Vector3d in_camera = cam_from_world * point.cast<double>();
    const std::optional<Eigen::Vector2d> pixel = camera.Project(in_camera);
    if (!pixel || pixel->minCoeff() < 0 || pixel->x() >= camera.width || pixel->y() >= camera.height) continue;
    const int column = static_cast<int>(pixel->x()) / cell, row = static_cast<int>(pixel->y()) / cell;
    layer.cells[static_cast<std::size_t>(row) * layer.columns + column].emplace_back(pixel->x(), pixel->y(),
                                                                                     static_cast<float>(in_camera.z()));
  }
  layers_.push_back(std::move(layer));
}

std::optional<double> MatchTruth::DepthAt(int view, const Eigen::Vector2d& pixel) const {
  const Layer& layer = layers_[view];
  const int cell = CellPx(set_->input.calibration->camera);
  const int rows = static_cast<int>(layer.cells.size()) / layer.columns;
  const int column = static_cast<int>(pixel.x()) / cell, row = static_cast<int>(pixel.y()) / cell;
  std::vector<Eigen::Vector3f> around;
  for (int r = std::max(0, row - 1); r <= std::min(rows - 1, row + 1); ++r) {
    for (int c = std::max(0, column - 1); c <= std::min(layer.columns - 1, column + 1); ++c) {
      const auto& points = layer.cells[static_cast<std::size_t>(r) * layer.columns + c];
      around.insert(around.end(), points.begin(), points.end());
    }
  }
  float nearest = std::numeric_limits<float>::max();
  for (const Eigen::Vector3f& point : around) nearest = std::min(nearest, point.z());
  std::erase_if(around, [nearest](const Eigen::Vector3f& point) { return point.z() > nearest + kLayerMm; });
  return around.size() < kMinPoints ? std::nullopt : PlaneDepth(around, pixel);
}

double MatchTruth::EpipolarPx(int first, const Eigen::Vector2d& first_px, int second,
                              const Eigen::Vector2d& second_px) const {
  const PinholeCamera& camera = set_->input.calibration->camera;
  const Rigid3 relative = set_->views[second].cam_from_world * set_->views[first].cam_from_world.Inverse();
  const Eigen::Vector3d a = camera.NormalisedFromPixel(first_px).homogeneous();
  const Eigen::Vector3d b = camera.NormalisedFromPixel(second_px).homogeneous();
  const Eigen::Vector3d line = relative.translation.cross(relative.rotation * a);
  const Eigen::Vector3d back = relative.rotation.transpose() * b.cross(relative.translation);
  const double sampson = std::abs(b.dot(line)) / std::sqrt(line.head<2>().squaredNorm() + back.head<2>().squaredNorm());
  return 0.5 * (camera.fx + camera.fy) * sampson;
}

bool MatchTruth::IsWrong(int first, const Eigen::Vector2d& first_px, int second,
                         const Eigen::Vector2d& second_px) const {
  if (EpipolarPx(first, first_px, second, second_px) > kMaxEpipolarPx) return true;
  if (!has_surface()) return false;
  const std::optional<double> depth = DepthAt(first, first_px);
  if (!depth) return false;
  const PinholeCamera& camera = set_->input.calibration->camera;
  const Eigen::Vector3d point = *depth * camera.NormalisedFromPixel(first_px).homogeneous();
  const Eigen::Vector3d world = set_->views[first].cam_from_world.Inverse() * point;
  const std::optional<Eigen::Vector2d> expected = camera.Project(set_->views[second].cam_from_world * world);
  return !expected || (*expected - second_px).norm() > kMaxSurfacePx;
}

}  // namespace drupe
