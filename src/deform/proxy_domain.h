#pragma once

#include <span>
#include <vector>

#include <meshgraft/core/context.h>
#include <meshgraft/deform/constraints.h>
#include <meshgraft/mesh/mesh.h>
#include <meshgraft/mesh/topology.h>

#include "constrained_system.h"
#include "decimate.h"
#include "region_states.h"

namespace meshgraft {

/// What of a mesh a proxy is made from: the region's unknown part and enough rings around it. Vertices are
/// numbered anew, in ascending order.
struct ProxyDomain {
  std::vector<Index> vertices;  ///< numbers in the mesh
  Points points;                ///< from the middle of their box
  Eigen::RowVector3d centre;    ///< that middle
  Triangles triangles;
  IndexLists rings;
  Points normals;
  Index unknown_vertices = 0;  ///< whose position or map is not given
  double spacing = 0;          ///< edge length of an even triangulation of theirs with the wanted vertices
  /// A number for all vertices that are held by the same thing; -1 where nothing holds.
  std::vector<Index> holder;

  Index size() const { return static_cast<Index>(vertices.size()); }
};

/// Empty where nothing is unknown. `holder` is over the mesh. Throws Error(input) for a coordinate that is not
/// finite.
ProxyDomain make_proxy_domain(const Points& rest, const Triangles& triangles, const VertexStates& states,
                              std::span<const Index> holder, int laplacian_order, Index wanted,
                              const Context& context);

/// The vertices that a proxy has to keep: of what is held, some beside what is not, no farther apart than the
/// spacing (or all with `all`), and those that span its extent.
Flags vertices_to_keep(const ProxyDomain& domain, bool all);

/// How far each of the proxy's vertices has to reach for what was removed around it; 0 where nothing was.
std::vector<double> proxy_reaches(const ProxyDomain& domain, const Decimated& proxy);

}  // namespace meshgraft
