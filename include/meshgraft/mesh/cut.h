#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include <Eigen/Core>

#include <meshgraft/core/context.h>
#include <meshgraft/mesh/mesh.h>

namespace meshgraft {

/// Name of the vertex attribute with the uncut surface's unit normals on the loops that a cut makes (3
/// components, NaN away from the cut). A graft can then continue the original surface.
inline constexpr const char* cut_normal_name = "cut_normal";

enum class CutKeep { above, below, both };

struct CutOptions {
  CutKeep keep = CutKeep::both;
  /// An edge that is cut within this fraction of its length from an end is cut at that end instead. The end
  /// is moved there, which avoids slivers. 0 keeps every vertex in place.
  double snap = 0.1;
};

struct CutResult {
  /// The kept vertices in their order, then those on the cut; with `both`, those on the cut twice.
  Mesh mesh;
  IndexMap vertex;                 ///< uncut mesh → `mesh`; a vertex on the cut maps to its first copy
  std::vector<EdgePoint> origin;   ///< per vertex of `mesh`: its location on the uncut mesh
  std::vector<Index> face_parent;  ///< per face of `mesh`: the uncut face that it is a piece of
  /// Per face of `mesh`: 1 above, -1 below, 0 where the cut separates nothing.
  std::vector<std::int8_t> face_side;
  /// The boundary loops that the cut made, as `boundary_loops` lists them.
  std::vector<std::vector<Index>> loops;
};

/// Returns the vertices of the uncut mesh that a cut touches, ascending: ends of cut edges, and vertices on
/// the cut.
std::vector<Index> vertices_at_cut(const CutResult& result);

/// Cuts a mesh along the zero set of a function with one value per vertex, linear along edges. Vertices are
/// inserted on the edges that the zero set crosses, and faces are split there; "above" is where the function
/// is positive. Open meshes may be cut across their boundary. Attributes follow their interpolation rule;
/// corner values stay within their face. Throws Error(input) for a wrong number of values, for non-finite
/// values, and where nothing is cut (mesh.nothing_cut).
CutResult cut_at_zero(const Mesh& mesh, std::span<const double> values, const CutOptions& options = {},
                      const Context& context = {});

/// Cuts by a plane, whose normal points above. Throws Error(input) with the id mesh.plane_misses_mesh where the
/// mesh lies on one side.
CutResult cut_by_plane(const Mesh& mesh, const Plane& plane, const CutOptions& options = {},
                       const Context& context = {});

/// Cuts along the closed curve that joins the listed vertices, in order, by shortest paths on the surface.
/// "Above" is on the left, seen from outside. Throws Error(input) for fewer than three vertices, repeated or
/// unconnected ones (mesh.no_path), and for a curve that crosses itself (mesh.loop_crosses_itself).
CutResult cut_along_loop(const Mesh& mesh, std::span<const Index> vertices, const CutOptions& options = {},
                         const Context& context = {});

}  // namespace meshgraft
