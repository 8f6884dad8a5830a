#pragma once

#include <array>
#include <vector>

#include <meshgraft/mesh/mesh.h>

namespace meshgraft {

/// The origin of a face of a joined mesh.
enum class SeamSide { target, source, strip };

/// The order of the faces of a joined mesh: the target's, the source's, the strips'.
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

/// The surroundings of the strips as triangles with local indices, so that the cost of work on a seam does
/// not grow with the joined meshes.
struct SeamPatch {
  std::vector<Index> vertex;   ///< indices in the whole mesh, ascending
  Points points;               ///< n×3
  Triangles triangles;         ///< m×3, local indices
  std::vector<SeamSide> side;  ///< per triangle
  std::vector<SeamSide> of;    ///< per vertex: the mesh that it comes from
  std::vector<int> ring;       ///< per vertex: 1 on a strip, then one more per ring of faces
  Flags on_border;             ///< per vertex: on a boundary edge of the whole mesh or of the patch
};

/// Returns the faces within `rings` rings of the strips.
SeamPatch make_seam_patch(const Mesh& mesh, const SeamLayout& layout, int rings);

/// An edge between two triangles of a patch.
struct SeamEdge {
  std::array<Index, 2> ends, triangles;
  double dihedral_deg = 0;  ///< 0° is flat
};

std::vector<SeamEdge> inner_edges(const SeamPatch& patch);

}  // namespace meshgraft
