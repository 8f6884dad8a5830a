#pragma once

#include <vector>

#include <meshgraft/core/context.h>
#include <meshgraft/mesh/mesh.h>

namespace meshgraft {

/// Some faces of a mesh, the whole, with their vertices and attributes, in the order of the whole.
struct MeshPart {
  Mesh mesh;
  std::vector<Index> vertices;  ///< per vertex: its index in the whole
  std::vector<Index> faces;     ///< per face: its index in the whole
};

/// Returns the part of a mesh that consists of the given faces, which must ascend and have no index out of
/// range.
MeshPart part_of(const Mesh& whole, std::vector<Index> faces);

/// Faces and vertices for the place of a part of a mesh. They may share vertices with the rest of the whole.
struct Replacement {
  const Mesh& mesh;
  std::vector<Index> vertex;  ///< per vertex of `mesh`: the vertex of the whole that it is, or -1 for a new one
  std::vector<Index> face;  ///< per face of `mesh`, ascending: the part's face (in the whole) that it replaces
};

struct ReplaceResult {
  Mesh mesh;
  IndexMap whole;        ///< vertices of the whole → `mesh`; -1 for those of the part that are not kept
  IndexMap replacement;  ///< vertices of the replacement → `mesh`
};

/// Replaces a part of a mesh. The kept vertices of the whole come first, in their order, then the new ones. The
/// faces stay in the order of the whole; each face of the part makes way for those that replace it. The
/// attributes are the replacement's; elsewhere they have the values of the whole, or are missing (NaN).
ReplaceResult replace_part(const Mesh& whole, const MeshPart& part, const Replacement& replacement,
                           const Context& context = {});

}  // namespace meshgraft
