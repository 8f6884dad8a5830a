#include "coincident.h"

#include <algorithm>
#include <bit>
#include <cstdint>
#include <utility>

namespace meshgraft {

namespace {

// Returns equal hashes for equal positions; adding 0 turns -0 into 0. Non-finite vertices coincide with no
// other vertex. Each gets a hash of its own, because millions of equal hashes would make the comparison
// quadratic.
std::uint64_t hash_of(const Points& positions, Index vertex) {
  std::uint64_t hash = 0;
  if (!positions.row(vertex).allFinite()) return static_cast<std::uint64_t>(vertex) * 0x9E3779B97F4A7C15ull;
  for (int axis = 0; axis < 3; ++axis) {
    hash ^= std::bit_cast<std::uint64_t>(positions(vertex, axis) + 0.0);
    hash *= 0x9E3779B97F4A7C15ull;
    hash ^= hash >> 32;
  }
  return hash;
}

// Returns pairs of a hash and an index into `vertices`, sorted. Bucketing first makes the sort linear.
std::vector<std::pair<std::uint64_t, Index>> by_hash(const Points& positions, std::span<const Index> vertices) {
  const auto bits = static_cast<int>(std::bit_width(vertices.size() / 4));
  const auto bucket = [bits](std::uint64_t hash) { return bits == 0 ? 0 : hash >> (64 - bits); };
  std::vector<std::uint64_t> hash(vertices.size());
  std::vector<std::size_t> start((std::size_t{1} << bits) + 1, 0);
  for (std::size_t k = 0; k < vertices.size(); ++k) {
    hash[k] = hash_of(positions, vertices[k]);
    ++start[bucket(hash[k]) + 1];
  }
  for (std::size_t b = 1; b < start.size(); ++b) start[b] += start[b - 1];
  std::vector<std::pair<std::uint64_t, Index>> order(vertices.size());
  std::vector<std::size_t> cursor(start.begin(), start.end() - 1);
  for (std::size_t k = 0; k < vertices.size(); ++k)
    order[cursor[bucket(hash[k])]++] = {hash[k], static_cast<Index>(k)};
  for (std::size_t b = 1; b < start.size(); ++b)
    std::sort(order.begin() + static_cast<std::ptrdiff_t>(start[b - 1]),
              order.begin() + static_cast<std::ptrdiff_t>(start[b]));
  return order;
}

}  // namespace

std::vector<Index> coincident_classes(const Points& positions, std::span<const Index> vertices) {
  std::vector<std::pair<std::uint64_t, Index>> order = by_hash(positions, vertices);
  std::vector<Index> classes(vertices.begin(), vertices.end());
  const auto representative = [&](std::size_t k) { return positions.row(vertices[order[k].second]); };
  for (std::size_t begin = 0; begin < order.size();) {
    std::size_t end = begin + 1;
    while (end < order.size() && order[end].first == order[begin].first) ++end;
    for (std::size_t k = begin + 1; k < end; ++k) {  // equal hashes: nearly always one position
      for (std::size_t first = begin; first < k; ++first) {
        if (representative(first) != representative(k)) continue;
        classes[order[k].second] = classes[order[first].second];
        break;
      }
    }
    begin = end;
  }
  return classes;
}

std::vector<Index> boundary_vertices(Index vertex_count, const EdgeTable& table) {
  Flags on_boundary(vertex_count, 0);
  for (Index e = 0; e < table.edge_count(); ++e)
    if (table.half_edges[e].size() == 1) on_boundary[table.ends[e][0]] = on_boundary[table.ends[e][1]] = 1;
  std::vector<Index> vertices;
  for (Index v = 0; v < vertex_count; ++v)
    if (on_boundary[v]) vertices.push_back(v);
  return vertices;
}

IndexLists coincident_boundary_edges(const EdgeTable& table, std::span<const Index> representative) {
  // Buckets by the smaller representative, each sorted by (larger representative, half-edge).
  const auto positions_of = [&](Index e) {
    return std::minmax(representative[table.ends[e][0]], representative[table.ends[e][1]]);
  };
  const auto counts = [&](Index e) {
    return table.half_edges[e].size() == 1 && positions_of(e).first >= 0 &&
           positions_of(e).first != positions_of(e).second;
  };
  std::vector<Index> start(representative.size() + 1, 0);
  for (Index e = 0; e < table.edge_count(); ++e)
    if (counts(e)) ++start[positions_of(e).first + 1];
  for (std::size_t v = 0; v < representative.size(); ++v) start[v + 1] += start[v];
  std::vector<std::pair<Index, Index>> bucket(start.back());
  std::vector<Index> cursor(start.begin(), start.end() - 1);
  for (Index e = 0; e < table.edge_count(); ++e)
    if (counts(e)) bucket[cursor[positions_of(e).first]++] = {positions_of(e).second, table.half_edges[e][0]};

  IndexLists rows;
  for (std::size_t v = 0; v < representative.size(); ++v) {
    std::sort(bucket.begin() + start[v], bucket.begin() + start[v + 1]);
    for (Index first = start[v]; first < start[v + 1];) {
      Index last = first + 1;
      while (last < start[v + 1] && bucket[last].first == bucket[first].first) ++last;
      if (last - first > 1) {
        for (Index k = first; k < last; ++k) rows.values.push_back(bucket[k].second);
        rows.offsets.push_back(static_cast<Index>(rows.values.size()));
      }
      first = last;
    }
  }
  return rows;
}

std::vector<Index> open_seam_vertices(const Mesh& mesh, const EdgeTable& table) {
  const std::vector<Index> boundary = boundary_vertices(mesh.vertex_count(), table);
  const std::vector<Index> classes = coincident_classes(mesh.positions, boundary);
  std::vector<Index> representative(mesh.vertex_count(), -1);
  for (std::size_t k = 0; k < boundary.size(); ++k) representative[boundary[k]] = classes[k];
  std::vector<Index> ends;
  for (const Index half_edge : coincident_boundary_edges(table, representative).values)
    ends.insert(ends.end(), {mesh.faces.corners()[half_edge], mesh.faces.corners()[table.next[half_edge]]});
  std::sort(ends.begin(), ends.end());
  ends.erase(std::unique(ends.begin(), ends.end()), ends.end());
  std::vector<Index> shared(mesh.vertex_count(), 0);
  for (const Index v : ends) ++shared[representative[v]];
  std::erase_if(ends, [&](Index v) { return shared[representative[v]] < 2; });
  return ends;
}

std::vector<Index> open_seam_vertices(const Mesh& mesh, const SimpleSurface& surface) {
  std::vector<Index> boundary;
  for (const Index corner : surface.leaving) boundary.push_back(mesh.faces.corners()[corner]);
  if (coincident_classes(mesh.positions, boundary) == boundary) return {};
  return open_seam_vertices(mesh, EdgeTable(mesh.vertex_count(), mesh.faces));
}

}  // namespace meshgraft
