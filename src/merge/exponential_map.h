#pragma once

#include <vector>

#include <Eigen/Core>

#include <meshgraft/core/context.h>
#include <meshgraft/mesh/mesh.h>
#include <meshgraft/mesh/topology.h>

#include "outline.h"

namespace meshgraft {

/// The tangent plane that a surface is spread out on.
struct ChartOrigin {
  Eigen::RowVector3d point, normal, first_axis;  ///< unit vectors, orthogonal to each other
  std::vector<Index> seeds;                      ///< vertices at the point or around it
};

/// A surface of triangles around a point, spread out on the tangent plane there: distance and direction from
/// the point along the surface (Schmidt, Grimm and Wyvill 2006). n×2; NaN for vertices that are more than an
/// edge farther than `reach`. Places come from all neighbours that are nearer, weighted by nearness.
PlanePoints exponential_map(const Points& positions, const Points& normals, const IndexLists& rings,
                            const ChartOrigin& origin, double reach, const Context& context);

}  // namespace meshgraft
