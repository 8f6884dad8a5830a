#pragma once

#include <string>

#include <meshgraft/core/error.h>
#include <meshgraft/deform/deform_problem.h>
#include <meshgraft/mesh/mesh.h>

namespace meshgraft {

/// Throws Error(input) with the id core.no_such_vertex at `location` unless 0 ≤ vertex < count.
void require_vertex(Index vertex, Index count, const Location& location);

/// Throws Error(input) if the handle is empty or has a vertex index out of range.
void require_handle_vertices(const Handle& handle, Index vertex_count);

/// Throws Error(input) if a corner of a triangle is not a row of `rest`.
void require_triangles(const Points& rest, const Triangles& triangles);

/// Throws Error(input), naming the field, if an option of the method is out of range.
void validate(const DeformerOptions& options);
/// Throws Error(input) if a value of the constraint is not finite, or so large that squares overflow.
void validate(const VertexConstraint& constraint);

}  // namespace meshgraft
