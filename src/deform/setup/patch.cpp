#include "patch.h"

#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <utility>

#include <meshgraft/core/error.h>

#include "core/parallel.h"
#include "deform/facts.h"
#include "mesh/edge_table.h"

namespace meshgraft {

namespace {

/// Adds the vertices of all faces around `front` to `inside`, and returns those that are new.
std::vector<Index> next_ring(const std::vector<Index>& front, const Triangles& triangles,
                             const IndexLists& vertex_triangles, Flags& inside) {
  std::vector<Index> next;
  for (Index v : front) {
    for (Index t : vertex_triangles[v]) {
      for (int corner = 0; corner < 3; ++corner) {
        const Index w = triangles(t, corner);
        if (inside[w]) continue;
        inside[w] = 1;
        next.push_back(w);
      }
    }
  }
  return next;
}

void require_finite(const Points& points, const std::vector<Index>& vertices) {
  for (Index v : vertices) {
    if (!points.row(v).allFinite()) throw Error(facts::deform::VertexNotFinite{.vertex = v});
  }
}

/// Returns whether any two faces at an edge are oriented inconsistently: they run along it in one direction.
bool any_inconsistent(Index vertex_count, const Triangles& triangles, const Context& context) {
  const IndexLists faces_at = vertex_triangles(vertex_count, triangles, context);
  std::atomic<bool> found = false;
  parallel_blocks(
      vertex_count,
      [&](std::size_t begin, std::size_t end) {
        std::vector<Index> ends;
        for (auto v = static_cast<Index>(begin); v < static_cast<Index>(end); ++v) {
          ends.clear();
          for (const Index t : faces_at[v])
            for (int corner = 0; corner < 3; ++corner)
              if (triangles(t, corner) == v) ends.push_back(triangles(t, (corner + 1) % 3));
          std::sort(ends.begin(), ends.end());
          if (std::adjacent_find(ends.begin(), ends.end()) != ends.end()) found = true;
        }
      },
      context);
  return found;
}

/// Reverses faces until any two faces that alone share an edge are consistently oriented. Otherwise
/// normals, which are sums over faces, would cancel. Each connected component keeps its first face. Where no
/// consistent orientation exists (a Möbius strip), some edges remain inconsistent. A consistently oriented
/// patch is not changed.
void orient_consistently(Index vertex_count, Triangles& triangles) {
  struct Neighbour {
    Index face = -1;
    bool opposed = false;  ///< the orientations are inconsistent
  };
  std::vector<std::array<Neighbour, 3>> neighbours(triangles.rows());
  Flags filled(neighbours.size(), 0);
  bool any_opposed = false;
  for (const TriangleEdge& edge : list_edges(triangles, vertex_triangles(vertex_count, triangles))) {
    if (!edge.joins_two_faces()) continue;
    const bool opposed = !edge.is_balanced();
    any_opposed = any_opposed || opposed;
    const auto [a, b] = edge.faces;
    neighbours[a][filled[a]++] = {b, opposed};
    neighbours[b][filled[b]++] = {a, opposed};
  }
  if (!any_opposed) return;
  enum : std::uint8_t { unseen, kept, reversed };
  std::vector<std::uint8_t> state(neighbours.size(), unseen);
  std::vector<Index> queue;
  for (Index start = 0; start < triangles.rows(); ++start) {
    if (state[start] != unseen) continue;
    state[start] = kept;
    queue.assign(1, start);
    while (!queue.empty()) {
      const Index face = queue.back();
      queue.pop_back();
      for (const Neighbour& next : neighbours[face]) {
        if (next.face < 0 || state[next.face] != unseen) continue;
        const bool reverse = (state[face] == reversed) != next.opposed;
        state[next.face] = reverse ? reversed : kept;
        queue.push_back(next.face);
      }
    }
    queue.clear();
  }
  for (Index t = 0; t < triangles.rows(); ++t)
    if (state[t] == reversed) std::swap(triangles(t, 1), triangles(t, 2));
}

/// Moves the centre of the patch's box to the origin and divides by a power of two near its diagonal.
void normalise(Patch& patch, const Points& points) {
  Eigen::RowVector3d low = points.row(patch.vertices.front()), high = low;
  for (Index v : patch.vertices) {
    low = low.cwiseMin(points.row(v));
    high = high.cwiseMax(points.row(v));
  }
  patch.centre = low + (high - low) / 2;
  const double diagonal = (high - low).stableNorm();
  patch.scale = diagonal > 0 ? std::exp2(std::round(std::log2(diagonal))) : 1.0;
  patch.points.resize(patch.size(), 3);
  for (Index i = 0; i < patch.size(); ++i)
    patch.points.row(i) = (points.row(patch.vertices[i]) - patch.centre) / patch.scale;
}

}  // namespace

Index Patch::local(Index global) const {
  const auto found = std::lower_bound(vertices.begin(), vertices.end(), global);
  return found != vertices.end() && *found == global ? static_cast<Index>(found - vertices.begin()) : -1;
}

Patch make_patch(const Points& points, const Triangles& triangles, const IndexLists& vertex_triangles,
                 std::span<const std::uint8_t> flagged, int rings, const Context& context) {
  context.throw_if_stopped();
  Flags inside(flagged.begin(), flagged.end());
  Patch patch;
  for (Index v = 0; v < static_cast<Index>(flagged.size()); ++v)
    if (flagged[v]) patch.vertices.push_back(v);
  if (patch.vertices.empty()) return patch;

  std::vector<Index> front = patch.vertices;
  for (int ring = 0; ring <= rings; ++ring) {
    front = next_ring(front, triangles, vertex_triangles, inside);
    patch.vertices.insert(patch.vertices.end(), front.begin(), front.end());
  }
  std::sort(patch.vertices.begin(), patch.vertices.end());
  require_finite(points, patch.vertices);
  normalise(patch, points);

  // Collects the faces with all corners inside, each once. All faces around a vertex are included, except in
  // the outermost ring.
  std::vector<Index> faces;
  for (Index v : patch.vertices) {
    for (Index t : vertex_triangles[v]) {
      const Index smallest = triangles.row(t).minCoeff();
      if (v == smallest && inside[triangles(t, 0)] && inside[triangles(t, 1)] && inside[triangles(t, 2)])
        faces.push_back(t);
    }
  }
  std::sort(faces.begin(), faces.end());
  faces.erase(std::unique(faces.begin(), faces.end()), faces.end());
  std::vector<Index> local(flagged.size());  // valid for vertices of the patch
  for (Index i = 0; i < patch.size(); ++i) local[patch.vertices[i]] = i;
  patch.triangles.resize(static_cast<Eigen::Index>(faces.size()), 3);
  parallel_blocks(
      faces.size(),
      [&](std::size_t begin, std::size_t end) {
        for (std::size_t f = begin; f < end; ++f)
          for (int corner = 0; corner < 3; ++corner)
            patch.triangles(static_cast<Eigen::Index>(f), corner) = local[triangles(faces[f], corner)];
      },
      context, 4096);
  patch.reoriented = any_inconsistent(patch.size(), patch.triangles, context);
  if (patch.reoriented) orient_consistently(patch.size(), patch.triangles);
  return patch;
}

}  // namespace meshgraft
