#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <string>
#include <vector>

namespace drupe {

/// A surface of triangles whose corners run counter-clockwise seen from outside.
struct TriangleMesh {
  std::vector<Eigen::Vector3f> vertices;                ///< mm when the scale is metric
  std::vector<std::array<std::uint32_t, 3>> triangles;  ///< indices in vertices

  bool empty() const { return triangles.empty(); }
  /// Of the space it encloses; negative when it is inside out. Means nothing unless it is closed.
  double Volume() const;
  double Area() const;
  /// True when every edge belongs to two triangles that run along it in opposite directions: nothing leaks out.
  bool IsClosed() const;
};

/// The content of mesh.ply: binary little-endian, float x y z a vertex, then faces as lists of three indices.
std::string WritePlyMesh(const TriangleMesh& mesh);

}  // namespace drupe
