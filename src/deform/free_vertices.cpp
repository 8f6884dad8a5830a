#include "free_vertices.h"

#include <string>

#include <meshgraft/core/error.h>

namespace meshgraft {

Flags flag_free(Eigen::Index vertex_count, std::span<const Index> free_vertices) {
  Flags is_free(static_cast<std::size_t>(vertex_count), 0);
  for (const Index v : free_vertices) {
    if (v < 0 || v >= vertex_count) {
      throw Error(ErrorCode::usage, "free vertex " + std::to_string(v) + " is not one of the " +
                                        std::to_string(vertex_count) + " vertices");
    }
    is_free[v] = 1;
  }
  return is_free;
}

void require_same_vertices(const Points& rest, const Points& edited) {
  if (rest.rows() == edited.rows()) return;
  throw Error(ErrorCode::usage,
              "rest has " + std::to_string(rest.rows()) + " vertices, edited " + std::to_string(edited.rows()));
}

}  // namespace meshgraft
