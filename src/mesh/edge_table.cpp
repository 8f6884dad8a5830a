#include "edge_table.h"

#include <algorithm>
#include <utility>

#include "core/parallel.h"
#include "core/sparse_checks.h"

namespace meshgraft {

namespace {

// Links the corners of one face into a cycle. Returns false if the face is unusable.
bool link_face(std::span<const Index> face, Index first_corner, Index vertex_count, EdgeTable& table) {
  std::array<Index, 2> seen{-1, -1};  // first and latest corner that is kept
  Index kept = 0;
  for (const Index vertex : face) {
    if (vertex < 0 || vertex >= vertex_count) return false;
  }
  for (std::size_t c = 0; c < face.size(); ++c) {
    if (face[c] == face[c == 0 ? face.size() - 1 : c - 1]) continue;
    const Index corner = first_corner + static_cast<Index>(c);
    if (kept++ == 0) {
      seen[0] = corner;
    } else {
      table.next[seen[1]] = corner;
      table.previous[corner] = seen[1];
    }
    seen[1] = corner;
  }
  if (kept > 0) {
    table.next[seen[1]] = seen[0];
    table.previous[seen[0]] = seen[1];
  }
  if (kept >= 3) return true;
  for (std::size_t c = 0; c < face.size(); ++c) {
    table.next[first_corner + static_cast<Index>(c)] = -1;
    table.previous[first_corner + static_cast<Index>(c)] = -1;
  }
  return false;
}

bool repeats_vertex(const Triangles& triangles, Index t) {
  return triangles(t, 0) == triangles(t, 1) || triangles(t, 1) == triangles(t, 2) ||
         triangles(t, 2) == triangles(t, 0);
}

}  // namespace

EdgeTable::EdgeTable(Index vertex_count, const Faces& faces, const Context& context)
    : next(faces.corner_count(), -1), previous(faces.corner_count(), -1), edge(faces.corner_count(), -1) {
  SparseChecks check(context);
  for (Index f = 0; f < faces.size(); ++f) {
    check();
    if (link_face(faces[f], faces.first_corner(f), vertex_count, *this)) ++usable_faces;
  }

  // Buckets by the smaller end, each sorted by (larger end, half-edge): linear for bounded valence.
  const std::vector<Index>& corners = faces.corners();
  const auto ends_of = [&](Index c) { return std::minmax(corners[c], corners[next[c]]); };
  std::vector<Index> start(static_cast<std::size_t>(vertex_count) + 1, 0);
  for (Index c = 0; c < faces.corner_count(); ++c) {
    if (next[c] >= 0) ++start[ends_of(c).first + 1];
  }
  for (Index v = 0; v < vertex_count; ++v) start[v + 1] += start[v];
  context.throw_if_stopped();
  std::vector<std::pair<Index, Index>> bucket(start.back());
  std::vector<Index> cursor(start.begin(), start.end() - 1);
  for (Index c = 0; c < faces.corner_count(); ++c) {
    check();
    if (next[c] >= 0) bucket[cursor[ends_of(c).first]++] = {ends_of(c).second, c};
  }

  half_edges.values.reserve(bucket.size());
  half_edges.offsets.reserve(bucket.size() / 2 + 1);
  ends.reserve(bucket.size() / 2 + 1);
  for (Index v = 0; v < vertex_count; ++v) {
    check();
    std::sort(bucket.begin() + start[v], bucket.begin() + start[v + 1]);
    for (Index k = start[v]; k < start[v + 1]; ++k) {
      if (k == start[v] || bucket[k].first != bucket[k - 1].first) {
        if (!ends.empty()) half_edges.offsets.push_back(k);
        ends.push_back({v, bucket[k].first});
      }
      edge[bucket[k].second] = static_cast<Index>(ends.size()) - 1;
      half_edges.values.push_back(bucket[k].second);
    }
  }
  if (!ends.empty()) half_edges.offsets.push_back(static_cast<Index>(half_edges.values.size()));
}

namespace {

struct EdgeSide {
  Index head, face;
  bool forward;
  auto operator<=>(const EdgeSide&) const = default;
};

// Appends the edges from a vertex to larger neighbours. `sides` is memory for the work.
void append_edges(Index v, const Triangles& triangles, std::span<const Index> faces,
                  std::vector<EdgeSide>& sides, std::vector<TriangleEdge>& edges) {
  sides.clear();
  for (const Index f : faces) {
    if (repeats_vertex(triangles, f)) continue;
    const int c = triangles(f, 0) == v ? 0 : triangles(f, 1) == v ? 1 : 2;
    const Index next = triangles(f, (c + 1) % 3), previous = triangles(f, (c + 2) % 3);
    if (next > v) sides.push_back({next, f, true});
    if (previous > v) sides.push_back({previous, f, false});
  }
  std::sort(sides.begin(), sides.end());
  for (const EdgeSide& side : sides) {
    if (edges.empty() || edges.back().ends[0] != v || edges.back().ends[1] != side.head)
      edges.push_back({{v, side.head}});
    TriangleEdge& edge = edges.back();
    const Index faces_before = edge.forward + edge.backward;
    if (faces_before < 2) edge.faces[faces_before] = side.face;
    ++(side.forward ? edge.forward : edge.backward);
  }
}

}  // namespace

std::vector<TriangleEdge> list_edges(const Triangles& triangles, const IndexLists& vertex_triangles,
                                     const Context& context) {
  return list_edges_from(0, vertex_triangles.size(), triangles, vertex_triangles, context);
}

std::vector<TriangleEdge> list_edges_from(Index first, Index last, const Triangles& triangles,
                                          const IndexLists& vertex_triangles, const Context& context) {
  constexpr std::size_t block_size = 8192;  // vertices
  const auto count = static_cast<std::size_t>(last - first);
  std::vector<std::vector<TriangleEdge>> blocks((count + block_size - 1) / block_size);
  parallel_blocks(
      blocks.size(),
      [&](std::size_t begin, std::size_t end) {
        std::vector<EdgeSide> sides;
        for (std::size_t block = begin; block < end; ++block)
          for (std::size_t v = block * block_size; v < std::min(count, (block + 1) * block_size); ++v)
            append_edges(first + static_cast<Index>(v), triangles,
                         vertex_triangles[first + static_cast<Index>(v)], sides, blocks[block]);
      },
      context, 1);
  std::size_t total = 0;
  for (const auto& block : blocks) total += block.size();
  std::vector<TriangleEdge> edges;
  edges.reserve(total);
  for (auto& block : blocks) {
    edges.insert(edges.end(), block.begin(), block.end());
    block = {};
  }
  return edges;
}

}  // namespace meshgraft
