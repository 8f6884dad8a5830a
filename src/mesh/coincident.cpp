#include "coincident.h"

#include <algorithm>
#include <bit>
#include <cstdint>
#include <utility>

namespace meshgraft {

namespace {

// Equal for equal places; adding 0 makes -0 the same as 0.
std::uint64_t hash_of(const Points& positions, Index vertex) {
  std::uint64_t hash = 0;
  for (int axis = 0; axis < 3; ++axis) {
    hash ^= std::bit_cast<std::uint64_t>(positions(vertex, axis) + 0.0);
    hash *= 0x9E3779B97F4A7C15ull;
    hash ^= hash >> 32;
  }
  return hash;
}

}  // namespace

std::vector<Index> coincident_classes(const Points& positions, std::span<const Index> vertices) {
  std::vector<std::pair<std::uint64_t, Index>> order;  // hash, place in `vertices`
  order.reserve(vertices.size());
  for (std::size_t k = 0; k < vertices.size(); ++k)
    order.emplace_back(hash_of(positions, vertices[k]), static_cast<Index>(k));
  std::sort(order.begin(), order.end());
  std::vector<Index> classes(vertices.begin(), vertices.end());
  const auto place = [&](std::size_t k) { return positions.row(vertices[order[k].second]); };
  for (std::size_t begin = 0; begin < order.size();) {
    std::size_t end = begin + 1;
    while (end < order.size() && order[end].first == order[begin].first) ++end;
    for (std::size_t k = begin + 1; k < end; ++k) {  // equal hashes: nearly always one place
      for (std::size_t first = begin; first < k; ++first) {
        if (place(first) != place(k)) continue;
        classes[order[k].second] = classes[order[first].second];
        break;
      }
    }
    begin = end;
  }
  return classes;
}

std::vector<Index> boundary_vertices(Index vertex_count, const EdgeTable& table) {
  std::vector<char> on_boundary(vertex_count, 0);
  for (Index e = 0; e < table.edge_count(); ++e)
    if (table.half_edges[e].size() == 1) on_boundary[table.ends[e][0]] = on_boundary[table.ends[e][1]] = 1;
  std::vector<Index> vertices;
  for (Index v = 0; v < vertex_count; ++v)
    if (on_boundary[v]) vertices.push_back(v);
  return vertices;
}

std::vector<std::vector<Index>> coincident_boundary_edges(const EdgeTable& table,
                                                          std::span<const Index> place) {
  using Key = std::pair<Index, Index>;
  std::vector<std::pair<Key, Index>> keyed;
  for (Index e = 0; e < table.edge_count(); ++e) {
    if (table.half_edges[e].size() != 1) continue;
    const Index half_edge = table.half_edges[e][0];
    const Key key = std::minmax(place[table.ends[e][0]], place[table.ends[e][1]]);
    if (key.first >= 0 && key.first != key.second) keyed.emplace_back(key, half_edge);
  }
  std::sort(keyed.begin(), keyed.end());
  std::vector<std::vector<Index>> rows;
  for (std::size_t begin = 0; begin < keyed.size();) {
    std::size_t end = begin + 1;
    while (end < keyed.size() && keyed[end].first == keyed[begin].first) ++end;
    if (end - begin > 1) {
      rows.emplace_back();
      for (std::size_t k = begin; k < end; ++k) rows.back().push_back(keyed[k].second);
    }
    begin = end;
  }
  std::sort(rows.begin(), rows.end());
  return rows;
}

}  // namespace meshgraft
