#pragma once

#include <span>
#include <vector>

#include <meshgraft/core/context.h>
#include <meshgraft/mesh/mesh.h>

namespace meshgraft {

/// Returns one flag per vertex that tells whether it is free. Throws Error(usage) if a free vertex does not
/// exist.
Flags flag_free(Eigen::Index vertex_count, std::span<const Index> free_vertices);

/// Returns for each triangle whether one of its vertices is flagged.
Flags flag_faces(const Triangles& triangles, const Flags& vertices, const Context& context);

/// Throws Error(usage) unless both have the same number of vertices.
void require_same_vertices(const Points& rest, const Points& edited);

}  // namespace meshgraft
