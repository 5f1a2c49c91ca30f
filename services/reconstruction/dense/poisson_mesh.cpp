#include "reconstruction/dense/poisson_mesh.h"

#include <pcl/PolygonMesh.h>
#include <pcl/conversions.h>
#include <pcl/point_types.h>
#include <pcl/surface/poisson.h>

#include <exception>
#include <utility>

#include "reconstruction/dense/preview.h"
#include "reconstruction/dense/unseen_side.h"

namespace drupe {

namespace {

constexpr std::size_t kLeastPoints = 100;
constexpr std::size_t kMostPoints = 200'000;  ///< more cost time and change the volume by less than its error
constexpr int kDepth = 8;                     ///< of the octree: cells of about 1/250 of the cloud's extent
constexpr float kPointsPerCell = 2;

pcl::PointCloud<pcl::PointNormal>::Ptr ToPcl(const PointCloud& cloud) {
  auto points = std::make_shared<pcl::PointCloud<pcl::PointNormal>>();
  points->reserve(cloud.size());
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    pcl::PointNormal point;
    point.getVector3fMap() = cloud.positions[i];
    point.getNormalVector3fMap() = cloud.normals[i];
    points->push_back(point);
  }
  return points;
}

TriangleMesh FromPcl(const pcl::PointCloud<pcl::PointXYZ>& vertices, const std::vector<pcl::Vertices>& polygons) {
  TriangleMesh mesh;
  for (const pcl::PointXYZ& vertex : vertices) mesh.vertices.push_back(vertex.getVector3fMap());
  for (const pcl::Vertices& polygon : polygons) {
    if (polygon.vertices.size() != 3) continue;
    mesh.triangles.push_back({static_cast<std::uint32_t>(polygon.vertices[0]),
                              static_cast<std::uint32_t>(polygon.vertices[1]),
                              static_cast<std::uint32_t>(polygon.vertices[2])});
  }
  return mesh;
}

/// `extent`: of the cube that is worked in, by that of the points. A surface that bulges out of it is cut open.
TriangleMesh Reconstruct(const PointCloud& cloud, float extent) {
  pcl::Poisson<pcl::PointNormal> poisson;
  poisson.setDepth(kDepth);
  poisson.setSamplesPerNode(kPointsPerCell);
  poisson.setScale(extent);
  poisson.setThreads(1);  // the result must not depend on the number of threads
  poisson.setInputCloud(ToPcl(cloud));
  pcl::PointCloud<pcl::PointXYZ> vertices;
  std::vector<pcl::Vertices> polygons;
  pcl::PointCloud<pcl::PointNormal> points;
  poisson.reconstruct(points, polygons);
  for (const pcl::PointNormal& point : points) vertices.emplace_back(point.x, point.y, point.z);
  TriangleMesh mesh = FromPcl(vertices, polygons);
  if (mesh.Volume() < 0) {
    for (auto& triangle : mesh.triangles) std::swap(triangle[1], triangle[2]);
  }
  return mesh;
}

}  // namespace

Result<TriangleMesh> BuildPoissonMesh(const PointCloud& cloud, const RunContext& context) {
  DRUPE_RETURN_IF_ERROR(context.CheckCancelled());
  if (cloud.size() < kLeastPoints || cloud.normals.size() != cloud.size()) {
    return Unprocessable("no_mesh", "a mesh needs at least 100 points with normals");
  }
  try {
    PointCloud points = DecimateCloud(cloud, kMostPoints);
    const PointCloud unseen = dense::GuessUnseenSide(points);
    points.positions.insert(points.positions.end(), unseen.positions.begin(), unseen.positions.end());
    points.normals.insert(points.normals.end(), unseen.normals.begin(), unseen.normals.end());
    for (const float extent : {1.5f, 2.0f}) {
      TriangleMesh mesh = Reconstruct(points, extent);
      DRUPE_RETURN_IF_ERROR(context.CheckCancelled());
      if (!mesh.empty() && mesh.IsClosed()) return mesh;
    }
    return Unprocessable("no_mesh", "the points give no closed surface");
  } catch (const std::exception& error) {
    return Internal("internal", std::string("mesh: ") + error.what());
  }
}

}  // namespace drupe
