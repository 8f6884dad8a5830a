#pragma once

#include <span>
#include <vector>

#include <meshgraft/core/context.h>
#include <meshgraft/deform/deform_problem.h>
#include <meshgraft/mesh/mesh.h>
#include <meshgraft/mesh/topology.h>

#include "decimate.h"
#include "deform/setup/region_mask.h"
#include "deform/solve/constrained_system.h"

namespace meshgraft {

/// The part of a mesh from which a proxy is made: the region's unknown vertices and enough rings around them.
/// Vertices are renumbered in ascending order.
struct ProxyDomain {
  std::vector<Index> vertices;  ///< indices in the mesh
  Points points;                ///< relative to `centre`
  Eigen::RowVector3d centre;    ///< centre of the vertices' box
  Triangles triangles;
  IndexLists rings;
  Points normals;
  Index unknown_vertices = 0;  ///< number of vertices with an unknown position or map
  double spacing = 0;          ///< edge length of an even triangulation with the wanted number of vertices
  /// Per vertex: the number of its holder (a handle, a feature, …), or -1 without one.
  std::vector<Index> holder;

  Index size() const { return static_cast<Index>(vertices.size()); }
};

/// Returns the domain, empty if nothing is unknown. `holder` is per vertex of the mesh. Throws Error(input)
/// if a coordinate is not finite.
ProxyDomain make_proxy_domain(const Points& rest, const Triangles& triangles, const ConstraintMask& mask,
                              std::span<const Index> holder, int laplacian_order, Index wanted,
                              const Context& context);

/// Flags the vertices that a proxy has to keep, which lie on handle boundaries. A boundary vertex has a holder
/// and a neighbour with another holder or none. With `all`, these are all boundary vertices. Otherwise they are
/// no farther apart than the spacing, and include vertices that span the boundary's extent.
Flags vertices_to_keep(const ProxyDomain& domain, bool all);

/// Returns the influence radius that each proxy vertex needs to cover the removed vertices around it, or 0 if
/// none was removed.
std::vector<double> influence_radii(const ProxyDomain& domain, const Decimated& proxy);

}  // namespace meshgraft
