#include "free_vertices.h"

#include <meshgraft/core/error.h>

#include "core/facts.h"
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

void require_same_vertices(const Points& rest, const Points& edited) {
  if (rest.rows() == edited.rows()) return;
  throw Error(facts::core::SizeMismatch{
      .what = facts::core::Rows::edited_positions, .given = edited.rows(), .needed = rest.rows()});
}

}  // namespace meshgraft
