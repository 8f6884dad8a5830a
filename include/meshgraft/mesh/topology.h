#pragma once

#include <array>
#include <limits>
#include <optional>
#include <span>
#include <vector>

#include <meshgraft/core/context.h>
#include <meshgraft/mesh/mesh.h>

namespace meshgraft {

/// Compressed lists: the entries of row i are `values[offsets[i]] … values[offsets[i+1]-1]`.
struct IndexLists {
  std::vector<Index> offsets{0};
  std::vector<Index> values;
  Index size() const { return static_cast<Index>(offsets.size()) - 1; }
  std::span<const Index> operator[](Index row) const {
    return {values.data() + offsets[row], static_cast<std::size_t>(offsets[row + 1] - offsets[row])};
  }
};

/// Returns for each vertex the triangles that contain it, ascending, in one linear pass. Throws Error(input)
/// if an index is out of range.
IndexLists vertex_triangles(Index vertex_count, const Triangles& triangles, const Context& context = {});

/// Returns for each vertex its ring N(i): the vertices that share an edge with it, ascending, without
/// repeats.
IndexLists vertex_rings(Index vertex_count, const Triangles& triangles, const Context& context = {});
/// Returns the same from existing lists of `vertex_triangles`.
IndexLists vertex_rings(const Triangles& triangles, const IndexLists& vertex_triangles,
                        const Context& context = {});

/// Returns rings over the polygons' own edges; diagonals of triangulated polygons do not count.
IndexLists vertex_rings(Index vertex_count, const Faces& faces);

/// Returns the boundary loops: closed chains of the half-edges that have one face. Each has the direction of
/// its face's half-edges (surface on the left, seen from outside) and begins with its smallest vertex. Loops
/// with the most vertices come first, equal ones in lexicographic order.
///
/// Chains that meet in a vertex are separated by following the fan of faces around it. A chain that cannot be
/// closed (it ends at an edge of three or more faces) is left out. Here and below, repeated corners of a face
/// are skipped. A face with fewer than three corners left or with an index out of range is ignored.
std::vector<std::vector<Index>> boundary_loops(const Mesh& mesh);

/// Returns the connected component of each vertex (0-based, in order of the smallest vertex). Vertices that
/// share a face are connected. Isolated vertices get -1. `count` receives the number of components if it is
/// not null.
std::vector<Index> connected_components(const Mesh& mesh, Index* count = nullptr);

/// Boundary vertices at exactly the same position. They are copies of one point, made by a soup (every face
/// with vertices of its own) or by a seam (of UVs, of hard edges, of a material).
struct Weld {
  /// Per vertex: the smallest vertex at its position; empty if none coincide.
  std::vector<Index> representative;
  Index copies = 0;  ///< vertices with another vertex as representative

  bool empty() const { return representative.empty(); }
  Index of(Index vertex) const { return empty() ? vertex : representative[vertex]; }
};

/// The results of `vertex_rings` (of the faces), `connected_components` and `boundary_loops`, computed from
/// one table of edges.
struct Connectivity {
  IndexLists rings;
  std::vector<Index> components;
  std::vector<std::vector<Index>> loops;
};
Connectivity connectivity(const Mesh& mesh);

/// Topological properties of a mesh. A mesh without faces is manifold and oriented, but not closed.
struct TopologySummary {
  Index vertices = 0;           ///< vertices used by a face
  Index isolated_vertices = 0;  ///< vertices used by no face
  Index faces = 0;
  Index edges = 0;
  Index components = 0;
  Index boundary_loops = 0;
  Index euler_characteristic = 0;  ///< V - E + F over used vertices and the faces that are not ignored
  /// Sum over components, (2·components - loops - χ)/2; absent where the surface is not an oriented manifold.
  std::optional<Index> genus;
  bool closed = false;    ///< no boundary edge
  bool manifold = false;  ///< every edge has one or two faces, every vertex one fan
  bool oriented = false;  ///< neighbouring faces are consistently oriented
};

/// Returns the topological properties of a mesh, from one table of its edges.
TopologySummary summarise_topology(const Mesh& mesh);

/// Returns the vertices within `rings` edges of `seeds` (seeds included), ascending. Throws Error(input) if a
/// seed is out of range.
std::vector<Index> grow_rings(std::span<const Index> seeds, int rings, const IndexLists& vertex_rings);

struct EdgeDistanceOptions {
  double limit = std::numeric_limits<double>::infinity();  ///< model units; the walk ends there
};

/// Returns each vertex's distance along edges (Dijkstra, model units) from the nearest seed, infinity beyond
/// the limit. Throws Error(input) if a seed is out of range.
std::vector<double> edge_distance(std::span<const Index> seeds, const Points& positions,
                                  const IndexLists& vertex_rings, const EdgeDistanceOptions& options = {});

}  // namespace meshgraft
