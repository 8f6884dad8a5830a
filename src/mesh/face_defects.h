#pragma once

#include <span>

#include <meshgraft/mesh/mesh.h>

namespace meshgraft {

bool is_vertex_of(const Mesh& mesh, Index vertex);

/// Returns whether all corners of a face are valid vertex indices.
bool in_range(std::span<const Index> face, Index vertex_count);
bool in_range(const Mesh& mesh, Index face);

/// Returns whether a face has fewer than three corners, or a vertex twice.
bool is_degenerate(std::span<const Index> face);

/// Returns whether a face has no area: twice its area is at most 1e-12 × its longest edge squared, or its
/// height is below the precision of its coordinates (4 ulp of the largest one).
bool has_no_area(std::span<const Index> face, const Points& positions);

/// Returns the same for a triangle; `largest` is the largest absolute value of the coordinates.
bool has_no_area(const Eigen::Vector3d& a, const Eigen::Vector3d& b, const Eigen::Vector3d& c, double largest);

}  // namespace meshgraft
