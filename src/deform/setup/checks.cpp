#include "checks.h"

#include <cmath>

#include <fmt/format.h>

#include <meshgraft/core/error.h>

#include "core/facts.h"
#include "core/require_between.h"
#include "deform/facts.h"

namespace meshgraft {

void require_vertex(Index vertex, Index count, const Location& location) {
  if (vertex < 0 || vertex >= count)
    throw Error(facts::core::NoSuchVertex{.vertex = vertex, .count = count}, location);
}

void require_handle_vertices(const Handle& handle, Index vertex_count) {
  const Location location = Location::handle(handle.name);
  if (handle.vertices.empty()) throw Error(facts::deform::NoVertices{}, location);
  for (const Index v : handle.vertices) require_vertex(v, vertex_count, location);
}

void require_triangles(const Points& rest, const Triangles& triangles) {
  const auto n = static_cast<Index>(rest.rows());
  for (Index t = 0; t < triangles.rows(); ++t)
    for (const Index v : triangles.row(t))
      if (v < 0 || v >= n) require_vertex(v, n, Location::place(fmt::format("triangle {}", t)));
}

void validate(const DeformerOptions& options) {
  require_between(options.stiffness, 0, 1e6, "stiffness");
  require_between(options.iterations, 0, 1000, "iterations");
  require_between(options.smoothing_length_rel, 0, 10, "smoothing_length_rel");
  require_between(options.vertices_represented, 0, 1e12, "vertices_represented");
}

void validate(const VertexConstraint& constraint) {
  if (constraint.rotation &&
      !(std::isfinite(constraint.rotation->angle()) && constraint.rotation->axis().allFinite()))
    throw Error(facts::core::NotFinite{.what = facts::core::Quantity::rotation},
                Location::place(fmt::format("the constraint of vertex {}", constraint.vertex)));
  const auto require = [&](const auto& matrix, facts::deform::Quantity what) {
    constexpr double largest = 1e100;  // so that squares and volumes stay finite
    if (matrix && !(matrix->array().abs() < largest).all())
      throw Error(facts::deform::TooLargeOrNotFinite{.what = what},
                  Location::place(fmt::format("the constraint of vertex {}", constraint.vertex)));
  };
  require(constraint.position, facts::deform::Quantity::position);
  require(constraint.transform, facts::deform::Quantity::transform);
}

}  // namespace meshgraft
