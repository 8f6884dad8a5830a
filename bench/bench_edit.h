#pragma once

#include <vector>

#include <Eigen/Geometry>

#include <meshgraft/deform/deformer.h>
#include <meshgraft/mesh/mesh.h>

namespace meshgraft::bench {

/// An edit of one handle; the region is the whole mesh.
struct BenchEdit {
  Points positions;
  Triangles triangles;
  std::vector<Index> fixed;
  std::vector<Index> handle;
  Eigen::Affine3d pose;  // of the handle
};

/// Returns the edit that every system is timed on: a square sheet with bumps, of about `vertex_count`
/// vertices (the nearest square number). Two rings of its border are fixed. The handle is a disc in its
/// middle, a tenth of the side in radius, turned by 45° out of the plane. The mesh is irregular (jittered
/// vertices, diagonals either way), because grids flatter orderings. The same call always gives the same
/// mesh.
BenchEdit make_bump_edit(Index vertex_count);

/// Returns an edit of any mesh: the lowest tenth along the longest side of its box is fixed, and the highest
/// tenth is the handle, turned by 45° about an axis across that side through its centroid.
BenchEdit make_bend_edit(const Mesh& mesh);

/// Returns the edit's region with its fixed vertices and its handle.
Region region_of(const BenchEdit& edit);

}  // namespace meshgraft::bench
