#include "ring_removal.h"

#include <algorithm>
#include <array>
#include <map>
#include <unordered_map>
#include <utility>

#include <meshgraft/core/error.h>

#include "merge/facts.h"
#include "mesh/edge_table.h"
#include "mesh/interpolate_attribute.h"
#include "mesh/refine.h"

namespace meshgraft {

namespace {

constexpr int most_halvings_for_length = 6, most_halvings_for_shape = 4;
constexpr Index no_ring = -1, several_rings = -2;

using Loops = std::vector<std::vector<Index>>;

void sort_unique(std::vector<Index>& indices) {
  std::sort(indices.begin(), indices.end());
  indices.erase(std::unique(indices.begin(), indices.end()), indices.end());
}

// The rings of faces around the loops of a mesh.
class Rings {
 public:
  Rings(const Mesh& mesh, const Loops& loops)
      : mesh_(mesh),
        table_(mesh.vertex_count(), mesh.faces),
        loop_sizes_(loops.size()),
        loop_of_(mesh.vertex_count(), no_ring),
        on_border_(mesh.vertex_count(), false),
        ring_of_(mesh.face_count(), no_ring),
        face_of_(mesh.faces.corner_count()),
        corners_(loops.size()) {
    for (std::size_t k = 0; k < loops.size(); ++k) {
      loop_sizes_[k] = loops[k].size();
      for (const Index v : loops[k]) loop_of_[v] = static_cast<Index>(k);
    }
    for (Index e = 0; e < table_.edge_count(); ++e) {
      if (table_.half_edges[e].size() != 1) continue;
      for (const Index v : table_.ends[e]) on_border_[v] = true;
    }
    for (Index f = 0; f < mesh.face_count(); ++f) gather(f);
  }

  bool is_kept(Index face) const { return ring_of_[face] == no_ring; }

  /// Returns the mean length of the edges along a loop.
  double mean_edge_length(std::size_t ring) const {
    double sum = 0;
    int count = 0;
    for (const Index c : corners_[ring]) {
      const auto& [a, b] = table_.ends[table_.edge[c]];
      // Edges along the loop only: faces that reach far across it (long walls) say nothing about the loop's
      // own resolution.
      if (loop_of_[a] == no_ring || loop_of_[b] == no_ring) continue;
      sum += (mesh_.positions.row(a) - mesh_.positions.row(b)).norm();
      ++count;
    }
    return count > 0 ? sum / count : 0;
  }

  /// Returns the loop that remains when the ring is removed, in the direction of the kept faces' half-edges.
  /// Returns an empty list where removing the ring would do more than move the boundary.
  std::vector<Index> outer_loop(std::size_t ring) const {
    const auto number = static_cast<Index>(ring);
    std::unordered_map<Index, Index> next;
    std::vector<Index> vertices, edges;
    std::size_t faces = 0;
    for (const Index c : corners_[ring]) {
      const Index tail = mesh_.faces.corners()[c], head = mesh_.faces.corners()[table_.next[c]];
      if (ring_of_[face_of_[c]] == several_rings) return {};
      faces += c == 0 || face_of_[c - 1] != face_of_[c];
      vertices.push_back(tail);
      edges.push_back(table_.edge[c]);
      const auto along = table_.half_edges[table_.edge[c]];
      if (along.size() > 2) return {};
      if (along.size() == 1) {
        if (loop_of_[tail] != number || loop_of_[head] != number) return {};  // another boundary
        continue;
      }
      const Index other = along[0] == c ? along[1] : along[0];
      if (mesh_.faces.corners()[other] == tail) return {};  // oriented inconsistently
      const Index beyond = ring_of_[face_of_[other]];
      if (beyond == number) continue;
      if (beyond != no_ring || on_border_[head] || !next.emplace(head, tail).second) return {};
    }
    sort_unique(vertices);
    sort_unique(edges);
    // The ring must be an annulus between the two loops: no other vertices, and V − E + F = 0.
    if (next.empty() || vertices.size() != loop_sizes_[ring] + next.size()) return {};
    if (vertices.size() + faces != edges.size()) return {};
    return one_cycle(next);
  }

 private:
  void gather(Index face) {
    Index& ring = ring_of_[face];
    for (const Index v : mesh_.faces[face]) {
      if (v < 0 || v >= mesh_.vertex_count() || loop_of_[v] == no_ring) continue;
      ring = ring == no_ring || ring == loop_of_[v] ? loop_of_[v] : several_rings;
    }
    for (Index c = mesh_.faces.first_corner(face); c < mesh_.faces.first_corner(face + 1); ++c) {
      face_of_[c] = face;
      if (table_.next[c] < 0) continue;
      if (ring >= 0) corners_[ring].push_back(c);
      if (ring != several_rings) continue;
      // A face with vertices of several loops is listed for each of them, so that each loop's check finds it.
      const Index loop = loop_of_[mesh_.faces.corners()[c]];
      if (loop != no_ring) corners_[loop].push_back(c);
    }
  }

  static std::vector<Index> one_cycle(const std::unordered_map<Index, Index>& next) {
    const Index first = std::min_element(next.begin(), next.end())->first;
    std::vector<Index> loop;
    Index v = first;
    do {
      loop.push_back(v);
      const auto following = next.find(v);
      if (following == next.end() || loop.size() > next.size()) return {};
      v = following->second;
    } while (v != first);
    if (loop.size() != next.size()) return {};
    return loop;
  }

  const Mesh& mesh_;
  EdgeTable table_;
  std::vector<std::size_t> loop_sizes_;
  std::vector<Index> loop_of_;  // per vertex
  Flags on_border_;             // per vertex
  std::vector<Index> ring_of_;  // per face
  std::vector<Index> face_of_;  // per corner
  Loops corners_;               // per ring: the corners of its faces that have edges
};

// Inserts the midpoints of halved edges between their ends into a loop.
void insert_middles(const RefineResult& refined, std::vector<Index>& loop) {
  const Index old_count = static_cast<Index>(refined.vertex.new_index.size());
  std::map<std::array<Index, 2>, Index> middle;
  for (std::size_t k = 0; k < refined.parents.size(); ++k) {
    middle.emplace(refined.parents[k], old_count + static_cast<Index>(k));
  }
  std::vector<Index> finer;
  for (std::size_t k = 0; k < loop.size(); ++k) {
    const auto [a, b] = std::minmax(loop[k], loop[(k + 1) % loop.size()]);
    finer.push_back(loop[k]);
    finer.push_back(middle.at({a, b}));
  }
  loop = std::move(finer);
}

// Empties the loops that share a vertex with another one.
void drop_touching(Loops& loops) {
  std::unordered_map<Index, std::size_t> owner;
  Flags touches(loops.size(), false);
  for (std::size_t k = 0; k < loops.size(); ++k) {
    for (const Index v : loops[k]) {
      const auto [entry, is_new] = owner.emplace(v, k);
      if (!is_new) touches[k] = touches[entry->second] = true;
    }
  }
  for (std::size_t k = 0; k < loops.size(); ++k) {
    if (touches[k]) loops[k].clear();
  }
}

// Returns the mesh without the faces of the rings and the vertices of the loops.
RingRemoval without(const Mesh& mesh, const Rings& rings, const Loops& loops) {
  Flags removed(mesh.vertex_count(), false);
  for (const auto& loop : loops) {
    for (const Index v : loop) removed[v] = true;
  }
  RingRemoval result;
  std::vector<Index>& new_index = result.vertex.new_index;
  std::vector<EdgePoint> vertices, faces, corners;
  for (Index v = 0; v < mesh.vertex_count(); ++v) {
    new_index.push_back(removed[v] ? -1 : static_cast<Index>(vertices.size()));
    if (!removed[v]) vertices.push_back({v, v, 0});
  }
  result.mesh.positions.resize(static_cast<Eigen::Index>(vertices.size()), 3);
  for (std::size_t k = 0; k < vertices.size(); ++k) {
    result.mesh.positions.row(static_cast<Eigen::Index>(k)) = mesh.positions.row(vertices[k].from);
  }
  std::vector<Index> face;
  for (Index f = 0; f < mesh.face_count(); ++f) {
    if (!rings.is_kept(f)) continue;
    face.clear();
    for (const Index v : mesh.faces[f]) face.push_back(v >= 0 && v < mesh.vertex_count() ? new_index[v] : -1);
    result.mesh.faces.push_back(face);
    faces.push_back({f, f, 0});
    for (Index c = mesh.faces.first_corner(f); c < mesh.faces.first_corner(f + 1); ++c)
      corners.push_back({c, c, 0});
  }
  for (const Attribute& attribute : mesh.attributes) {
    result.mesh.attributes.push_back(
        interpolate_attribute(attribute, attribute.domain == Domain::vertex ? vertices
                                         : attribute.domain == Domain::face ? faces
                                                                            : corners));
  }
  return result;
}

}  // namespace

RingRemoval remove_rings(const Mesh& mesh, std::span<const RingRequest> requests, const Context& context) {
  Loops loops;
  for (const RingRequest& request : requests) loops.push_back(request.loop);
  std::vector<int> for_length(loops.size(), 0), for_shape(loops.size(), 0);
  Mesh fine = mesh;
  for (;;) {
    context.throw_if_stopped();
    const Rings rings(fine, loops);
    Loops outer(loops.size());
    for (std::size_t k = 0; k < loops.size(); ++k) outer[k] = rings.outer_loop(k);
    drop_touching(outer);
    std::vector<std::size_t> to_halve;
    for (std::size_t k = 0; k < loops.size(); ++k) {
      constexpr double rounding = 1 + 1e-9;  // even loops meet the bound exactly, in any order of summation
      if (rings.mean_edge_length(k) > rounding * requests[k].longest_edge &&
          for_length[k] < most_halvings_for_length) {
        ++for_length[k];
        to_halve.push_back(k);
      } else if (outer[k].empty()) {
        if (for_shape[k]++ == most_halvings_for_shape)
          throw Error(facts::merge::RingNotRemovable{}, requests[k].location);
        to_halve.push_back(k);
      }
    }
    if (to_halve.empty()) {
      RingRemoval result = without(fine, rings, loops);
      for (std::size_t k = 0; k < loops.size(); ++k) {
        for (Index& v : outer[k]) v = result.vertex.new_index[v];
        // New indices keep the order, so each loop still begins with its smallest vertex.
        result.loops.push_back(std::move(outer[k]));
        result.halvings.push_back(for_length[k] + for_shape[k]);
      }
      result.vertex.new_index.resize(mesh.vertex_count());
      result.mesh.source = mesh.source;  // a writer uses the data that does not depend on the topology
      return result;
    }
    std::vector<Index> at;
    for (const std::size_t k : to_halve) at.insert(at.end(), loops[k].begin(), loops[k].end());
    RefineResult refined = split_edges_at(fine, at, {});
    for (const std::size_t k : to_halve) insert_middles(refined, loops[k]);
    fine = std::move(refined.mesh);
  }
}

}  // namespace meshgraft
