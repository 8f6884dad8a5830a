#include <meshgraft/mesh/topology.h>

#include <algorithm>
#include <numeric>
#include <string>
#include <utility>

#include <meshgraft/core/error.h>

#include "core/facts.h"
#include "core/parallel.h"
#include "disjoint_sets.h"
#include "edge_table.h"
#include "fans.h"
#include "shortest_distances.h"
#include "simple_surface.h"

namespace meshgraft {

namespace {

bool in_range(Index vertex, Index vertex_count) { return vertex >= 0 && vertex < vertex_count; }

[[noreturn]] void fail_index(Index vertex, Index vertex_count, const Location& location) {
  throw Error(facts::core::NoSuchVertex{.vertex = vertex, .count = vertex_count}, location);
}

void check_seeds(std::span<const Index> seeds, Index vertex_count) {
  for (const Index seed : seeds) {
    if (!in_range(seed, vertex_count)) fail_index(seed, vertex_count, "seeds");
  }
}

void prefix_sum(std::vector<Index>& counts) { std::partial_sum(counts.begin(), counts.end(), counts.begin()); }

// One boundary edge of a walk along a loop.
struct BoundaryStep {
  Index half_edge = -1;  // -1: the walk cannot continue
  bool forward = true;   // along the half-edge; false only between inconsistently oriented faces
};

class BoundaryWalk {
 public:
  BoundaryWalk(const Mesh& mesh, const EdgeTable& table) : corners_(mesh.faces.corners()), table_(table) {
    for (Index c = 0; c < static_cast<Index>(corners_.size()); ++c) {
      if (table_.next[c] >= 0 && table_.is_boundary(c)) boundary_.push_back(c);
    }
    by_tail_ = boundary_;
    std::stable_sort(by_tail_.begin(), by_tail_.end(),
                     [&](Index a, Index b) { return corners_[a] < corners_[b]; });
    used_.assign(corners_.size(), false);
  }

  std::vector<std::vector<Index>> closed_chains() {
    std::vector<std::vector<Index>> loops;
    for (const Index start : boundary_) {
      if (used_[start]) continue;
      std::vector<Index> loop;
      if (follow(start, loop)) loops.push_back(std::move(loop));
    }
    return loops;
  }

 private:
  Index tail(const BoundaryStep& step) const {
    return corners_[step.forward ? step.half_edge : table_.next[step.half_edge]];
  }
  Index head(const BoundaryStep& step) const {
    return corners_[step.forward ? table_.next[step.half_edge] : step.half_edge];
  }

  bool follow(Index start, std::vector<Index>& loop) {
    BoundaryStep step{start, true};
    while (step.half_edge >= 0 && !used_[step.half_edge]) {
      used_[step.half_edge] = true;
      loop.push_back(tail(step));
      const BoundaryStep last = step;
      step = across_fan(last);
      if (step.half_edge >= 0) continue;
      // The fan ends at an edge of three or more faces, so continue where another such fan leaves this
      // vertex.
      if (head(last) == corners_[start] && begins_chain(start)) return true;
      step = begin_at(head(last));
    }
    return step.half_edge == start;
  }

  BoundaryStep across_fan(const BoundaryStep& step) const {
    return step.forward ? turn(table_.next[step.half_edge], true) : turn(step.half_edge, false);
  }

  // Rotates around the vertex of `corner` until it meets a boundary edge, leaving its face over the outgoing
  // or the incoming half-edge. Ends because the sides of the faces around a vertex form paths.
  BoundaryStep turn(Index corner, bool outgoing) const {
    const Index vertex = corners_[corner];
    for (;;) {
      const Index half_edge = outgoing ? corner : table_.previous[corner];
      const auto along = table_.half_edges[table_.edge[half_edge]];
      if (along.size() == 1) return {half_edge, outgoing};
      if (along.size() > 2) return {};
      const Index twin = along[0] == half_edge ? along[1] : along[0];
      outgoing = corners_[twin] != vertex;
      corner = outgoing ? table_.next[twin] : twin;
    }
  }

  bool begins_chain(Index half_edge) const { return turn(half_edge, false).half_edge < 0; }

  BoundaryStep begin_at(Index vertex) const {
    auto candidate = std::lower_bound(by_tail_.begin(), by_tail_.end(), vertex,
                                      [&](Index half_edge, Index v) { return corners_[half_edge] < v; });
    for (; candidate != by_tail_.end() && corners_[*candidate] == vertex; ++candidate) {
      if (!used_[*candidate] && begins_chain(*candidate)) return {*candidate, true};
    }
    return {};
  }

  const std::vector<Index>& corners_;
  const EdgeTable& table_;
  std::vector<Index> boundary_;  // half-edges with one face, ascending
  std::vector<Index> by_tail_;   // the same, sorted by the vertex they leave
  Flags used_;
};

// Rotates a loop to begin with its smallest vertex. If the loop passes it twice, the occurrence with the
// smaller next vertex leads.
void begin_with_smallest(std::vector<Index>& loop) {
  const std::size_t n = loop.size();
  std::size_t best = 0;
  for (std::size_t k = 1; k < n; ++k) {
    if (std::pair(loop[k], loop[(k + 1) % n]) < std::pair(loop[best], loop[(best + 1) % n])) best = k;
  }
  std::rotate(loop.begin(), loop.begin() + static_cast<std::ptrdiff_t>(best), loop.end());
}

}  // namespace

IndexLists vertex_triangles(Index vertex_count, const Triangles& triangles, const Context& context) {
  const std::span<const Index> corners(triangles.data(), static_cast<std::size_t>(triangles.size()));
  for (std::size_t c = 0; c < corners.size(); ++c)
    if (!in_range(corners[c], vertex_count))
      fail_index(corners[c], vertex_count, Location::place("triangle " + std::to_string(c / 3)));
  return triangles_around(vertex_count, corners, context);
}

IndexLists vertex_rings(Index vertex_count, const Triangles& triangles, const Context& context) {
  return vertex_rings(triangles, vertex_triangles(vertex_count, triangles, context), context);
}

IndexLists vertex_rings(const Triangles& triangles, const IndexLists& vertex_triangles,
                        const Context& context) {
  // Each triangle contributes at most two neighbours: collects them with repeats, then closes the gaps.
  const Index count = vertex_triangles.size();
  std::vector<Index> gathered(2 * vertex_triangles.values.size());
  IndexLists rings;
  rings.offsets.assign(static_cast<std::size_t>(count) + 1, 0);
  const auto gather = [&](std::size_t begin, std::size_t end) {
    for (auto v = static_cast<Index>(begin); v < static_cast<Index>(end); ++v) {
      const auto first = gathered.begin() + 2 * std::ptrdiff_t{vertex_triangles.offsets[v]};
      auto last = first;
      for (const Index t : vertex_triangles[v]) {
        for (int c = 0; c < 3; ++c) {
          if (triangles(t, c) != v) *last++ = triangles(t, c);
        }
      }
      std::sort(first, last);
      rings.offsets[v + 1] = static_cast<Index>(std::unique(first, last) - first);
    }
  };
  parallel_blocks(count, gather, context);

  prefix_sum(rings.offsets);
  rings.values.resize(rings.offsets.back());
  const auto compact = [&](std::size_t begin, std::size_t end) {
    for (auto v = static_cast<Index>(begin); v < static_cast<Index>(end); ++v) {
      std::copy_n(gathered.begin() + 2 * std::ptrdiff_t{vertex_triangles.offsets[v]}, rings[v].size(),
                  rings.values.begin() + rings.offsets[v]);
    }
  };
  parallel_blocks(count, compact, context);
  return rings;
}

namespace {

IndexLists rings_of(Index vertex_count, const EdgeTable& table) {
  IndexLists rings;
  rings.offsets.assign(static_cast<std::size_t>(vertex_count) + 1, 0);
  for (const auto& ends : table.ends) {
    ++rings.offsets[ends[0] + 1];
    ++rings.offsets[ends[1] + 1];
  }
  prefix_sum(rings.offsets);
  rings.values.resize(rings.offsets.back());
  std::vector<Index> cursor(rings.offsets.begin(), rings.offsets.end() - 1);
  // Edges ascend in (smaller, larger), so each vertex gets its smaller neighbours first, and both kinds in
  // order.
  for (const auto& ends : table.ends) rings.values[cursor[ends[1]]++] = ends[0];
  for (const auto& ends : table.ends) rings.values[cursor[ends[0]]++] = ends[1];
  return rings;
}

std::vector<std::vector<Index>> loops_of(const Mesh& mesh, const EdgeTable& table) {
  auto loops = BoundaryWalk(mesh, table).closed_chains();
  for (auto& loop : loops) begin_with_smallest(loop);
  std::sort(loops.begin(), loops.end(),
            [](const auto& a, const auto& b) { return a.size() != b.size() ? a.size() > b.size() : a < b; });
  return loops;
}

std::vector<Index> components_of(Index vertex_count, const EdgeTable& table, Index& components) {
  DisjointSets sets(vertex_count);
  Flags used(vertex_count, false);
  for (const auto& ends : table.ends) {
    sets.unite(ends[0], ends[1]);
    used[ends[0]] = used[ends[1]] = true;
  }
  std::vector<Index> component(vertex_count, -1);
  components = 0;
  for (Index v = 0; v < vertex_count; ++v) {
    if (!used[v]) continue;
    const Index root = sets.root(v);  // the smallest vertex of the set, which is numbered already
    component[v] = root == v ? components++ : component[root];
  }
  return component;
}

}  // namespace

IndexLists vertex_rings(Index vertex_count, const Faces& faces) {
  return rings_of(vertex_count, EdgeTable(vertex_count, faces));
}

Connectivity connectivity(const Mesh& mesh) {
  if (const auto surface = find_simple_surface(mesh)) return connectivity(mesh, *surface);
  const EdgeTable table(mesh.vertex_count(), mesh.faces);
  Index count = 0;
  return {rings_of(mesh.vertex_count(), table), components_of(mesh.vertex_count(), table, count),
          loops_of(mesh, table)};
}

std::vector<std::vector<Index>> boundary_loops(const Mesh& mesh) {
  return loops_of(mesh, EdgeTable(mesh.vertex_count(), mesh.faces));
}

std::vector<Index> connected_components(const Mesh& mesh, Index* count) {
  Index components = 0;
  std::vector<Index> component =
      components_of(mesh.vertex_count(), EdgeTable(mesh.vertex_count(), mesh.faces), components);
  if (count) *count = components;
  return component;
}

TopologySummary summarise_topology(const Mesh& mesh) {
  const EdgeTable table(mesh.vertex_count(), mesh.faces);
  const std::vector<Index> fans = fan_counts(mesh, table);
  TopologySummary summary;
  summary.faces = mesh.face_count();
  summary.edges = table.edge_count();
  summary.isolated_vertices = static_cast<Index>(std::count(fans.begin(), fans.end(), 0));
  summary.vertices = mesh.vertex_count() - summary.isolated_vertices;
  summary.euler_characteristic = summary.vertices - summary.edges + table.usable_faces;
  components_of(mesh.vertex_count(), table, summary.components);
  summary.boundary_loops = static_cast<Index>(loops_of(mesh, table).size());

  summary.closed = table.edge_count() > 0;
  summary.manifold = std::none_of(fans.begin(), fans.end(), [](Index fan_count) { return fan_count > 1; });
  summary.oriented = true;
  for (Index e = 0; e < table.edge_count(); ++e) {
    const std::size_t faces = table.half_edges[e].size();
    if (faces == 1) summary.closed = false;
    if (faces > 2) summary.manifold = false;
    if (consistently_oriented(mesh, table, e) == false) summary.oriented = false;
  }
  if (summary.manifold && summary.oriented) {
    summary.genus = (2 * summary.components - summary.boundary_loops - summary.euler_characteristic) / 2;
  }
  return summary;
}

std::vector<Index> grow_rings(std::span<const Index> seeds, int rings, const IndexLists& vertex_rings) {
  check_seeds(seeds, vertex_rings.size());
  Flags reached(vertex_rings.size(), false);
  std::vector<Index> all;
  const auto reach = [&](Index v) {
    if (reached[v]) return;
    reached[v] = true;
    all.push_back(v);
  };
  for (const Index seed : seeds) reach(seed);
  std::size_t front = 0;
  for (int ring = 0; ring < rings && front < all.size(); ++ring) {
    for (const std::size_t end = all.size(); front < end; ++front) {
      for (const Index neighbour : vertex_rings[all[front]]) reach(neighbour);
    }
  }
  std::sort(all.begin(), all.end());
  return all;
}

std::vector<double> edge_distance(std::span<const Index> seeds, const Points& positions,
                                  const IndexLists& vertex_rings, const EdgeDistanceOptions& options) {
  check_seeds(seeds, vertex_rings.size());
  std::vector<double> distance(vertex_rings.size(), unreached);
  shortest_distances(seeds, distance, [&](Index v, double reached, const auto& offer) {
    for (const Index neighbour : vertex_rings[v]) {
      const double candidate = reached + (positions.row(neighbour) - positions.row(v)).norm();
      if (candidate > options.limit) continue;
      offer(neighbour, candidate);
    }
    return true;
  });
  return distance;
}

}  // namespace meshgraft
