#pragma once

#include <array>
#include <vector>

#include <meshgraft/mesh/mesh.h>

namespace meshgraft {

/// Where a face of a joined mesh comes from.
enum class SeamSide { target, source, strip };

/// How the faces of a joined mesh are ordered: the target's, the source's, the strips'.
struct SeamLayout {
  Index target_vertices = 0;
  Index target_faces = 0, source_faces = 0;
  SeamSide side_of_vertex(Index vertex) const {
    return vertex < target_vertices ? SeamSide::target : SeamSide::source;
  }
  SeamSide side_of_face(Index face) const {
    if (face < target_faces) return SeamSide::target;
    return face < target_faces + source_faces ? SeamSide::source : SeamSide::strip;
  }
};

/// The surroundings of the strips, as triangles with numbers of their own, so that work on a seam does not grow
/// with the meshes that it joins.
struct SeamPatch {
  std::vector<Index> vertex;   ///< in the whole mesh, ascending
  Points points;               ///< n×3
  Triangles triangles;         ///< m×3, of local indices
  std::vector<SeamSide> side;  ///< per triangle
  std::vector<SeamSide> of;    ///< per vertex: the mesh that it comes from
  std::vector<int> ring;       ///< per vertex: 1 on a strip, then one more per ring of faces
  Flags on_border;             ///< per vertex: on a boundary edge of the whole mesh
};

/// The faces within `rings` rings of the strips.
SeamPatch make_seam_patch(const Mesh& mesh, const SeamLayout& layout, int rings);

/// An edge between two triangles of a patch.
struct SeamEdge {
  std::array<Index, 2> ends, triangles;
  double dihedral_deg = 0;  ///< 0° is flat
};

std::vector<SeamEdge> inner_edges(const SeamPatch& patch);

}  // namespace meshgraft
