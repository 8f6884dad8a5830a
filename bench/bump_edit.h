#pragma once

#include <vector>

#include <Eigen/Geometry>

#include <meshgraft/mesh/mesh.h>

namespace meshgraft::bench {

/// The edit that every system is timed on: a square sheet with bumps, its border held, a disc in its middle
/// turned by 45°. The mesh is irregular (jittered vertices, diagonals either way), for grids flatter orderings.
struct BumpEdit {
  Points positions;
  Triangles triangles;
  std::vector<Index> fixed;   // two rings of vertices along the border
  std::vector<Index> handle;  // a disc with a tenth of the sheet's side as its radius
  Eigen::Affine3d pose;       // of the handle: 45° about a horizontal axis through its centre
};

/// About `vertex_count` vertices (the nearest square number); the same call always gives the same mesh.
BumpEdit make_bump_edit(Index vertex_count);

}  // namespace meshgraft::bench
