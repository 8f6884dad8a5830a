#pragma once

#include <vector>

#include <Eigen/Geometry>

#include <meshgraft/deform/deformer.h>
#include <meshgraft/mesh/mesh.h>

namespace meshgraft::bench {

/// One handle moved on a mesh that is the region as a whole.
struct BenchEdit {
  Points positions;
  Triangles triangles;
  std::vector<Index> fixed;
  std::vector<Index> handle;
  Eigen::Affine3d pose;  // of the handle
};

/// The edit that every system is timed on: a square sheet with bumps, two rings of its border held, a disc in
/// its middle (a tenth of the side as its radius) turned by 45° out of the plane. The mesh is irregular
/// (jittered vertices, diagonals either way), for grids flatter orderings. About `vertex_count` vertices (the
/// nearest square number); the same call always gives the same mesh.
BenchEdit make_bump_edit(Index vertex_count);

/// The edit's region, held as it says.
Region region_of(const BenchEdit& edit);

}  // namespace meshgraft::bench
