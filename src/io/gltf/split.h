#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include <meshgraft/mesh/mesh.h>

namespace meshgraft::io {

/// A triangle's corners as corners of the mesh.
using CornerTriangle = std::array<Index, 3>;

/// One primitive to be written: a mesh vertex and one of its corners for each vertex of the file.
struct SplitPrimitive {
  double material = 0;  ///< of all faces; NaN for none
  std::vector<CornerTriangle> triangles;
  std::vector<Index> vertex;           ///< of the mesh
  std::vector<Index> corner;           ///< of the mesh
  std::vector<std::uint32_t> indices;  ///< 3 per triangle, of the above
};

struct SplitObject {
  double object = 0;  ///< of all faces; NaN for none
  std::vector<SplitPrimitive> primitives;
};

struct SplitMesh {
  std::vector<SplitObject> objects;
  Index polygons = 0;         ///< faces of more than three corners
  Index lonely_vertices = 0;  ///< without a triangle
};

/// Triangles by their faces' `object` and `material`, in the order of the faces; a vertex is split where one of
/// its corner attributes differs.
SplitMesh split_mesh(const Mesh& mesh);

}  // namespace meshgraft::io
