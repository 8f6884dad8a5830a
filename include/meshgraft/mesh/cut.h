#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include <Eigen/Core>

#include <meshgraft/core/context.h>
#include <meshgraft/mesh/interpolate_attribute.h>
#include <meshgraft/mesh/mesh.h>

namespace meshgraft {

/// The name of the vertex attribute (3 components, NaN away from the cut) in which a cut keeps the uncut
/// surface's unit normals on the loops it makes, so that a part can be grafted as it grew.
inline constexpr const char* cut_normal_name = "cut_normal";

enum class CutKeep { above, below, both };

struct CutOptions {
  CutKeep keep = CutKeep::both;
  /// An edge that is cut within this fraction of its length from an end is cut at that end instead, which
  /// is moved there: no slivers. 0 keeps every vertex in place.
  double snap = 0.1;
};

struct CutResult {
  Mesh mesh;        ///< the kept vertices in their order, then those on the cut; with `both`, the cut's twice
  IndexMap vertex;  ///< from the uncut mesh; a vertex on the cut maps to its first copy
  std::vector<EdgePoint> origin;       ///< per vertex of `mesh`, where it lies on the uncut one
  std::vector<Index> face_parent;      ///< per face of `mesh`, the uncut face that it is a part of
  std::vector<std::int8_t> face_side;  ///< per face of `mesh`: 1 above, -1 below, 0 where the cut parts nothing
  std::vector<std::vector<Index>>
      loops;  ///< the boundary loops that the cut made, as `boundary_loops` lists them
};

/// The vertices of the uncut mesh that a cut touches, ascending: ends of cut edges, and vertices on the cut.
std::vector<Index> vertices_at_cut(const CutResult& result);

/// Cuts a mesh where a function given per vertex is zero, linear along edges: vertices are inserted on the
/// edges that it crosses, faces are split there; "above" is where it is positive. Open meshes may be cut across
/// their boundary. Attributes follow their interpolation rule, corner values stay within their face. Throws
/// Error(input) for a wrong number of values, values that are not finite, and where nothing is cut.
CutResult cut_at_zero(const Mesh& mesh, std::span<const double> values, const CutOptions& options = {},
                      const Context& context = {});

/// Cuts by the plane (x − point)·normal = 0; the normal points above and need not have unit length.
CutResult cut_by_plane(const Mesh& mesh, const Eigen::Vector3d& point, const Eigen::Vector3d& normal,
                       const CutOptions& options = {}, const Context& context = {});

/// Cuts along the closed curve that joins the listed vertices, in order, by shortest paths on the surface.
/// "Above" lies at the left hand, seen from outside. Throws Error(input) for fewer than three vertices (or
/// repeated, unconnected ones), and for a curve that crosses itself.
CutResult cut_along_loop(const Mesh& mesh, std::span<const Index> vertices, const CutOptions& options = {},
                         const Context& context = {});

}  // namespace meshgraft
