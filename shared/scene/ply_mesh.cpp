#include "scene/ply_mesh.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <utility>

#include "scene/ply_values.h"

namespace drupe {

double TriangleMesh::Volume() const {
  double six_volumes = 0;
  for (const auto& t : triangles) {
    const Eigen::Vector3d a = vertices[t[0]].cast<double>(), b = vertices[t[1]].cast<double>();
    six_volumes += a.dot(b.cross(vertices[t[2]].cast<double>()));
  }
  return six_volumes / 6;
}

double TriangleMesh::Area() const {
  double two_areas = 0;
  for (const auto& t : triangles) {
    const Eigen::Vector3d a = vertices[t[0]].cast<double>();
    two_areas += (vertices[t[1]].cast<double>() - a).cross(vertices[t[2]].cast<double>() - a).norm();
  }
  return two_areas / 2;
}

bool TriangleMesh::IsClosed() const {
  std::vector<std::pair<std::uint32_t, std::uint32_t>> edges, reversed;
  for (const auto& t : triangles) {
    for (int corner = 0; corner < 3; ++corner) {
      edges.emplace_back(t[corner], t[(corner + 1) % 3]);
      reversed.emplace_back(t[(corner + 1) % 3], t[corner]);
    }
  }
  std::sort(edges.begin(), edges.end());
  std::sort(reversed.begin(), reversed.end());
  return edges == reversed && std::adjacent_find(edges.begin(), edges.end()) == edges.end();
}

std::string WritePlyMesh(const TriangleMesh& mesh) {
  std::string out = "ply\nformat binary_little_endian 1.0\ncomment drupe mesh\nelement vertex " +
                    std::to_string(mesh.vertices.size()) +
                    "\nproperty float x\nproperty float y\nproperty float z\nelement face " +
                    std::to_string(mesh.triangles.size()) + "\nproperty list uchar uint vertex_indices\nend_header\n";
  out.reserve(out.size() + 12 * mesh.vertices.size() + 13 * mesh.triangles.size());
  for (const Eigen::Vector3f& vertex : mesh.vertices) PutValues(vertex.data(), 3, &out);
  for (const auto& triangle : mesh.triangles) {
    out.push_back(3);
    PutValues(triangle.data(), 3, &out);
  }
  return out;
}

}  // namespace drupe
