#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include <meshgraft/mesh/mesh.h>

namespace meshgraft::io {

/// A triangle, as three corners of the mesh.
using CornerTriangle = std::array<Index, 3>;

/// A primitive to be written. It stores a mesh vertex and one of its corners for each vertex of the file.
struct SplitPrimitive {
  double material = 0;  ///< label of all its faces; NaN for none
  std::vector<CornerTriangle> triangles;
  std::vector<Index> vertex;           ///< per file vertex: its mesh vertex
  std::vector<Index> corner;           ///< per file vertex: one of its mesh corners
  std::vector<std::uint32_t> indices;  ///< 3 per triangle, into `vertex` and `corner`
};

struct SplitObject {
  double object = 0;  ///< label of all its faces; NaN for none
  std::vector<SplitPrimitive> primitives;
};

struct SplitMesh {
  std::vector<SplitObject> objects;
  Index polygons = 0;         ///< faces of more than three corners
  Index lonely_vertices = 0;  ///< vertices without a triangle
};

/// Groups triangles by the `object` and `material` of their faces, in the order of the faces. A vertex is
/// split where one of its corner attributes differs.
SplitMesh split_mesh(const Mesh& mesh);

}  // namespace meshgraft::io
