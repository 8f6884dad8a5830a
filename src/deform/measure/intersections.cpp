#include <meshgraft/deform/quality.h>

#include <algorithm>
#include <atomic>
#include <mutex>
#include <string>
#include <utility>

#include <meshgraft/core/error.h>

#include "core/facts.h"
#include "core/memory.h"
#include "deform/facts.h"
#include "deform/setup/free_vertices.h"
#include "mesh/intersecting_triangles.h"

namespace meshgraft {

namespace {

void require_vertices(const Triangles& triangles, Eigen::Index vertex_count) {
  for (Eigen::Index t = 0; t < triangles.rows(); ++t)
    for (const Index v : triangles.row(t))
      if (v < 0 || v >= vertex_count)
        throw Error(facts::core::NoSuchVertex{.vertex = v, .count = vertex_count},
                    Location::place("triangle " + std::to_string(t)));
}

// Flags the triangles that have a free vertex.
Flags free_triangles(Eigen::Index vertex_count, const Triangles& triangles,
                     std::span<const Index> free_vertices, const Context& context) {
  const Flags is_free = flag_free(vertex_count, free_vertices);
  require_vertices(triangles, vertex_count);
  return flag_faces(triangles, is_free, context);
}

// Collects pairs from several threads.
class PairList {
 public:
  void add(const TrianglePair& pair) {
    const std::scoped_lock lock(adding_);
    if (pairs_.size() == pairs_.capacity() && 2 * pairs_.size() * sizeof(TrianglePair) > available_memory() / 8)
      throw Error(facts::deform::IntersectionsExceedMemory{});
    pairs_.push_back(pair);
  }
  std::vector<TrianglePair> sorted() && {
    std::sort(pairs_.begin(), pairs_.end());
    return std::move(pairs_);
  }

 private:
  std::mutex adding_;
  std::vector<TrianglePair> pairs_;
};

bool is_new(const EditedMesh& mesh, const TrianglePair& pair) {
  return !intersect(mesh.rest, mesh.triangles, pair);
}

}  // namespace

std::vector<TrianglePair> self_intersections(const Points& points, const Triangles& triangles,
                                             std::span<const Index> free_vertices, const Context& context) {
  PairList list;
  find_intersections(
      points, triangles, free_triangles(points.rows(), triangles, free_vertices, context),
      [&](const TrianglePair& pair) { list.add(pair); }, context);
  return std::move(list).sorted();
}

std::int64_t count_self_intersections(const Points& points, const Triangles& triangles,
                                      std::span<const Index> free_vertices, const Context& context) {
  std::atomic<std::int64_t> count = 0;
  find_intersections(
      points, triangles, free_triangles(points.rows(), triangles, free_vertices, context),
      [&](const TrianglePair&) { ++count; }, context);
  return count;
}

std::vector<TrianglePair> new_self_intersections(const EditedMesh& mesh, const Context& context) {
  require_same_vertices(mesh.rest, mesh.edited);
  PairList list;
  find_intersections(
      mesh.edited, mesh.triangles,
      free_triangles(mesh.edited.rows(), mesh.triangles, mesh.free_vertices, context),
      [&](const TrianglePair& pair) {
        if (is_new(mesh, pair)) list.add(pair);
      },
      context);
  return std::move(list).sorted();
}

std::int64_t count_new_self_intersections(const EditedMesh& mesh, const Context& context) {
  require_same_vertices(mesh.rest, mesh.edited);
  std::atomic<std::int64_t> count = 0;
  find_intersections(
      mesh.edited, mesh.triangles,
      free_triangles(mesh.edited.rows(), mesh.triangles, mesh.free_vertices, context),
      [&](const TrianglePair& pair) { count += is_new(mesh, pair); }, context);
  return count;
}

}  // namespace meshgraft
