#pragma once

#include <memory>
#include <span>
#include <vector>

#include <meshgraft/core/context.h>
#include <meshgraft/mesh/mesh.h>
#include <meshgraft/mesh/topology.h>

namespace meshgraft {

/// The connectivity of a mesh of triangles that is a consistently oriented manifold: every edge has one face,
/// or two that run along it in opposite directions, and every vertex that has faces has one fan of them. No
/// face repeats a vertex, and no two faces have the same vertices.
struct SimpleSurface {
  IndexLists faces_around;  ///< per vertex: its faces, ascending; none for an isolated vertex
  std::vector<Index>
      leaving;  ///< the corners whose half-edges have no opposite one; ascending in their vertices
  std::vector<Index> components;  ///< per vertex: the smallest vertex of its connected component

  bool is_closed() const { return leaving.empty(); }
};

/// Returns the connectivity of a mesh, or null if the mesh is not as `SimpleSurface` says. It is found in
/// parallel from the faces around each vertex, without a table of edges. The result does not depend on the
/// number of threads.
std::shared_ptr<const SimpleSurface> find_simple_surface(const Mesh& mesh, const Context& context = {});

/// Returns for each vertex the triangles that contain it, ascending. Triangle t has the corners 3t, 3t+1 and
/// 3t+2; they must be in range.
IndexLists triangles_around(Index vertex_count, std::span<const Index> corners, const Context& context = {});

/// Returns the rings, components and loops of a simple surface, as `connectivity` does.
Connectivity connectivity(const Mesh& mesh, const SimpleSurface& surface, const Context& context = {});

}  // namespace meshgraft
