#include "free_vertices.h"

#include <meshgraft/core/error.h>

#include "core/facts.h"
#include "core/parallel.h"
#include "deform/facts.h"

namespace meshgraft {

Flags flag_free(Eigen::Index vertex_count, std::span<const Index> free_vertices) {
  Flags is_free(vertex_count, 0);
  for (const Index v : free_vertices) {
    if (v < 0 || v >= vertex_count) {
      throw Error(facts::deform::NoSuchFreeVertex{.vertex = v, .count = vertex_count});
    }
    is_free[v] = 1;
  }
  return is_free;
}

Flags flag_faces(const Triangles& triangles, const Flags& vertices, const Context& context) {
  Flags faces(triangles.rows(), 0);
  parallel_blocks(
      faces.size(),
      [&](std::size_t begin, std::size_t end) {
        for (std::size_t f = begin; f < end; ++f) {
          const auto v = triangles.row(static_cast<Eigen::Index>(f));
          faces[f] = vertices[v[0]] || vertices[v[1]] || vertices[v[2]];
        }
      },
      context, 4096);
  return faces;
}

void require_same_vertices(const Points& rest, const Points& edited) {
  if (rest.rows() == edited.rows()) return;
  throw Error(facts::core::SizeMismatch{
      .what = facts::core::Rows::edited_positions, .given = edited.rows(), .needed = rest.rows()});
}

}  // namespace meshgraft
