#pragma once

#include <array>
#include <functional>
#include <span>
#include <vector>

#include <meshgraft/core/context.h>
#include <meshgraft/mesh/mesh.h>

namespace meshgraft {

struct RefineResult {
  Mesh mesh;        ///< old vertices first, in their order; then one per split edge
  IndexMap vertex;  ///< the identity on the old vertices
  /// For each new vertex (index - old vertex count): the ends of the edge that it halves.
  std::vector<std::array<Index, 2>> parents;
  std::vector<Index> face_parent;  ///< per face of `mesh`: the old face that it is a piece of
};

/// Predicate that returns whether the edge between two vertices (the smaller first) is to be split.
using EdgePredicate = std::function<bool(Index, Index)>;

/// Splits the chosen edges at their midpoints and subdivides the faces around them (red-green). A triangle
/// with three split edges becomes four triangles, with two three, with one two. Polygons that touch a split
/// edge are triangulated first, and their diagonals count as edges. An unsplit edge stays whole, so the
/// result has no T-junctions. Attributes follow their interpolation rule, and integer types are rounded.
/// Corner values stay within their face, so that seams stay seams. The file that the mesh was read from stays
/// known to writers.
RefineResult split_edges(const Mesh& mesh, const EdgePredicate& is_split, const Context& context = {});

/// Splits every edge that has both ends in `vertices`. Throws Error(input) if an index is out of range.
RefineResult split_edges_within(const Mesh& mesh, std::span<const Index> vertices, const Context& context = {});

/// Splits every edge that has an end in `vertices`; the mesh beyond the faces at these vertices is not
/// changed. Throws Error(input) if an index is out of range.
RefineResult split_edges_at(const Mesh& mesh, std::span<const Index> vertices, const Context& context = {});

}  // namespace meshgraft
