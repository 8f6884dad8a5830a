#pragma once

#include <vector>

#include <Eigen/Core>

#include <meshgraft/core/context.h>
#include <meshgraft/mesh/mesh.h>
#include <meshgraft/mesh/topology.h>

#include "outline.h"

namespace meshgraft {

/// The tangent plane of an exponential map.
struct ChartOrigin {
  Eigen::RowVector3d point, normal, first_axis;  ///< unit normal and axis, orthogonal to each other
  std::vector<Index> seeds;                      ///< vertices at the point or around it
};

/// Computes the discrete exponential map of a triangulated surface around a point: distance and direction
/// from the point along the surface (Schmidt, Grimm and Wyvill 2006). Returns n×2; NaN for vertices that are
/// more than an edge farther than `radius`. The coordinates of a vertex average the predictions of all nearer
/// neighbours, weighted by inverse distance.
PlanePoints exponential_map(const Points& positions, const Points& normals, const IndexLists& rings,
                            const ChartOrigin& origin, double radius, const Context& context);

}  // namespace meshgraft
