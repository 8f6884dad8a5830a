// Repair of torn surfaces: boundary edges that lie on each other, and vertices that lie on an edge.

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <optional>
#include <ranges>
#include <set>
#include <utility>

#include <Eigen/Geometry>

#include "core/parallel.h"
#include "mesh/box_diagonal.h"
#include "mesh/coincident.h"
#include "mesh/facts.h"
#include "mesh/vertex_tree.h"
#include "repair_surface.h"

namespace meshgraft {

std::vector<Index> boundary_positions(const RepairSurface& surface, std::optional<double> distance) {
  const double largest_share = distance ? 0.5 : 0.1;  // of the shortest edge
  const Points& positions = surface.positions();
  const Index count = surface.mesh().vertex_count();
  const std::vector<Index> boundary = boundary_vertices(count, surface.edges());
  const std::vector<Index> exact = coincident_classes(positions, boundary);
  std::vector<Index> representative(count, -1), representatives;
  std::vector<double> shortest = shortest_edges(surface),
                      largest(count, std::numeric_limits<double>::infinity());
  for (std::size_t k = 0; k < boundary.size(); ++k) {
    representative[boundary[k]] = exact[k];
    if (exact[k] == boundary[k]) representatives.push_back(exact[k]);
    largest[exact[k]] = std::min(largest[exact[k]], largest_share * shortest[boundary[k]]);
  }
  const double widest = weld_distance(surface, distance);
  if (!(widest > 0)) return representative;

  const VertexTree tree(positions, representatives);
  std::vector<std::vector<Index>> near(representatives.size());  // smaller ones, near enough for both
  parallel_blocks(
      representatives.size(),
      [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i) {
          const Index v = representatives[i];
          for (const Index w : tree.within(positions.row(v), std::min(widest, largest[v]))) {
            if (w < v && (positions.row(v) - positions.row(w)).norm() <= std::min(widest, largest[w]))
              near[i].push_back(w);
          }
        }
      },
      surface.context());
  DisjointSets sets(count);
  for (std::size_t i = 0; i < near.size(); ++i)
    for (const Index w : near[i]) sets.unite(representatives[i], w);
  for (const Index v : boundary) representative[v] = sets.root(representative[v]);
  return representative;
}

double weld_distance(const RepairSurface& surface, std::optional<double> distance) {
  constexpr double default_rel = 1e-6;
  return distance ? *distance : default_rel * box_diagonal_of_faces(surface.mesh());
}

namespace {

// Returns the pairs of half-edges at one position that may belong together, each pair once. Returns all
// pairs, or for many half-edges only those whose faces lie most nearly opposite.
std::vector<std::pair<std::size_t, std::size_t>> pairs_to_score(const std::vector<Eigen::RowVector3d>& inward,
                                                                const Eigen::RowVector3d& axis) {
  constexpr std::size_t crowd = 32, nearest = 8;
  const std::size_t n = inward.size();
  std::vector<std::pair<std::size_t, std::size_t>> pairs;
  if (n <= crowd) {
    for (std::size_t i = 0; i < n; ++i)
      for (std::size_t k = i + 1; k < n; ++k) pairs.emplace_back(i, k);
    return pairs;
  }
  const Eigen::RowVector3d across = axis.unitOrthogonal(), third = axis.cross(across);
  std::vector<std::pair<double, std::size_t>> around;
  for (std::size_t i = 0; i < n; ++i) {
    const double angle = std::atan2(inward[i].dot(third), inward[i].dot(across));
    around.emplace_back(std::isfinite(angle) ? angle : 0, i);  // the edge may have no length
  }
  std::sort(around.begin(), around.end());
  for (const auto& [angle, i] : around) {
    const double opposite = angle > 0 ? angle - std::numbers::pi : angle + std::numbers::pi;
    const auto at = static_cast<std::size_t>(
        std::lower_bound(around.begin(), around.end(), std::pair(opposite, std::size_t{0})) - around.begin());
    for (std::size_t step = 0; step < 2 * nearest; ++step) {
      const std::size_t k = around[(at + n - nearest + step) % n].second;
      if (k != i) pairs.emplace_back(std::min(i, k), std::max(i, k));
    }
  }
  std::sort(pairs.begin(), pairs.end());
  pairs.erase(std::unique(pairs.begin(), pairs.end()), pairs.end());
  return pairs;
}

}  // namespace

std::vector<ScoredPair> possible_pairs(const RepairSurface& surface, std::span<const Index> half_edges) {
  const EdgeTable& table = surface.edges();
  const std::vector<Index>& corners = surface.faces().corners();
  std::vector<Eigen::RowVector3d> along, inward;  // unit vectors into the face, perpendicular to the edge
  // A face that is connected by this edge alone more likely does not belong here.
  std::vector<double> loose;
  for (const Index c : half_edges) {
    along.emplace_back(
        (surface.positions().row(corners[table.next[c]]) - surface.positions().row(corners[c])).normalized());
    inward.emplace_back(surface.face_normal(surface.face_of(c)).cross(along.back()));
    double sides = 0;
    for (Index side = table.next[c]; side != c; side = table.next[side]) sides += table.is_boundary(side);
    loose.push_back(sides);
  }
  std::vector<ScoredPair> pairs;
  constexpr double against = 6;  // more than any sum of the other terms
  for (const auto& [i, k] : pairs_to_score(inward, along[0])) {
    const bool run_alike = along[i].dot(along[k]) > 0;
    pairs.push_back({inward[i].dot(inward[k]) + std::min(loose[i] + loose[k], 3.0) + (run_alike ? against : 0),
                     {half_edges[i], half_edges[k]}});
  }
  return pairs;
}

std::vector<std::array<Index, 2>> pair_up(std::vector<ScoredPair> possible) {
  std::stable_sort(possible.begin(), possible.end(),
                   [](const ScoredPair& x, const ScoredPair& y) { return x.score < y.score; });
  std::vector<std::array<Index, 2>> pairs;
  std::set<Index> taken;
  for (const auto& [score, half_edges] : possible) {
    if (taken.contains(half_edges[0]) || taken.contains(half_edges[1])) continue;
    pairs.push_back(half_edges);
    taken.insert(half_edges.begin(), half_edges.end());
  }
  return pairs;
}

std::vector<std::array<Index, 2>> pair_up(const RepairSurface& surface, std::span<const Index> half_edges) {
  if (half_edges.size() == 2) return {{half_edges[0], half_edges[1]}};
  return pair_up(possible_pairs(surface, half_edges));
}

// Joins edges, not vertices: components that meet only in a vertex stay separate, and no edge gets a third
// face.
bool stitch(RepairSurface& surface, std::optional<double> distance) {
  const EdgeTable& table = surface.edges();
  const std::vector<Index>& corners = surface.faces().corners();
  const std::vector<Index> representative = boundary_positions(surface, distance);
  DisjointSets sets(surface.mesh().vertex_count());
  surface.context().throw_if_stopped();
  const IndexLists rows = coincident_boundary_edges(table, representative);
  for (Index row = 0; row < rows.size(); ++row) {
    for (const auto& [a, b] : pair_up(surface, rows[row])) {
      const std::array ends{corners[a], corners[table.next[a]]};
      std::array others{corners[b], corners[table.next[b]]};
      if (representative[ends[0]] != representative[others[0]]) std::swap(others[0], others[1]);
      sets.unite(ends[0], others[0]);
      sets.unite(ends[1], others[1]);
    }
  }
  std::vector<Index> given;
  Index count = 0;
  for (Index v = 0; v < surface.mesh().vertex_count(); ++v) {
    if (sets.root(v) == v) continue;
    ++count;
    if (surface.vertex_origin(v) >= 0) given.push_back(surface.vertex_origin(v));
  }
  if (count == 0) return false;
  surface.report(RepairChangeKind::welded_vertex, Domain::vertex, std::move(given), count);
  surface.unite_vertices(sets);
  return true;
}

namespace {

// A vertex on a half-edge, at the fraction `t` of its length from its start.
struct OnEdge {
  double t = 0;
  Index vertex = -1;
};

struct TornEdges {
  std::vector<std::vector<OnEdge>> on;  // per half-edge, ascending in t
  std::vector<Index> vertices;          // all vertices that lie on a half-edge
};

// Returns the fraction of a half-edge at which a point lies. Returns nothing unless the point is at most
// `aside` from the half-edge and farther than `apart` from its ends.
std::optional<double> place_on(const Points& positions, Index a, Index b, const Eigen::RowVector3d& point,
                               double apart, double aside) {
  const Eigen::RowVector3d from = positions.row(a), way = positions.row(b) - from;
  const double length = way.norm();
  if (!(length > 2 * apart)) return {};
  const double t = (point - from).dot(way) / (length * length);
  if (!(t * length > apart) || !((1 - t) * length > apart)) return {};
  if (!((point - from - t * way).norm() <= aside)) return {};
  return t;
}

// Boundary vertices grouped by position, so that a position with thousands of vertices is searched once.
struct BoundaryPositions {
  std::vector<Index> first;                           // per position: the smallest vertex
  std::vector<std::pair<Index, Index>> first_vertex;  // per vertex: the first at its position, and the vertex

  BoundaryPositions(const Points& positions, const std::vector<Index>& boundary) {
    const std::vector<Index> classes = coincident_classes(positions, boundary);
    for (std::size_t k = 0; k < boundary.size(); ++k) {
      if (classes[k] == boundary[k]) first.push_back(classes[k]);
      first_vertex.emplace_back(classes[k], boundary[k]);
    }
    std::sort(first_vertex.begin(), first_vertex.end());
  }

  auto vertices_at(Index first_vertex_there) const {
    const auto [begin, end] =
        std::ranges::equal_range(first_vertex, first_vertex_there, {}, &std::pair<Index, Index>::first);
    return std::ranges::subrange(begin, end) | std::views::values;
  }
};

TornEdges find_torn_edges(const RepairSurface& surface, double widest) {
  const EdgeTable& table = surface.edges();
  const Points& positions = surface.positions();
  const std::vector<Index>& corners = surface.faces().corners();
  const BoundaryPositions boundary(positions, boundary_vertices(surface.mesh().vertex_count(), table));
  surface.context().throw_if_stopped();
  const VertexTree tree(positions, boundary.first);
  const std::vector<double> shortest = shortest_edges(surface);
  std::vector<std::vector<Index>> neighbours(surface.mesh().vertex_count());  // along the boundary
  for (Index e = 0; e < table.edge_count(); ++e) {
    if (table.half_edges[e].size() != 1) continue;
    neighbours[table.ends[e][0]].push_back(table.ends[e][1]);
    neighbours[table.ends[e][1]].push_back(table.ends[e][0]);
  }

  surface.context().throw_if_stopped();
  TornEdges torn;
  torn.on.resize(corners.size());
  const auto look_along = [&](Index c) {
    const Index a = corners[c], b = corners[table.next[c]];
    const auto face = surface.faces()[surface.face_of(c)];
    for (const Index first_vertex_there : tree.near_segment(positions.row(a), positions.row(b), widest)) {
      const bool at_end = positions.row(first_vertex_there) == positions.row(a) ||
                          positions.row(first_vertex_there) == positions.row(b);
      if (at_end || !place_on(positions, a, b, positions.row(first_vertex_there), 0, widest)) continue;
      for (const Index v : boundary.vertices_at(first_vertex_there)) {
        if (std::find(face.begin(), face.end(), v) != face.end()) continue;
        const double radius = std::min(widest, 0.1 * shortest[v]);
        const auto t = place_on(positions, a, b, positions.row(v), radius, radius);
        // A boundary edge must run along this one too, so that surfaces touching in a point stay unchanged.
        const bool runs_along = t && std::any_of(neighbours[v].begin(), neighbours[v].end(), [&](Index w) {
                                  const Eigen::RowVector3d point = positions.row(w);
                                  return (point - positions.row(a)).norm() <= radius ||
                                         (point - positions.row(b)).norm() <= radius ||
                                         place_on(positions, a, b, point, radius, radius);
                                });
        if (runs_along) torn.on[c].push_back({*t, v});
      }
    }
    std::sort(torn.on[c].begin(), torn.on[c].end(), [](const OnEdge& x, const OnEdge& y) { return x.t < y.t; });
  };
  if (!corners.empty()) surface.face_of(0);  // builds the table before several threads read it
  parallel_blocks(
      table.edge_count(),
      [&](std::size_t begin, std::size_t end) {
        for (std::size_t e = begin; e < end; ++e)
          if (table.half_edges[static_cast<Index>(e)].size() == 1)
            look_along(table.half_edges[static_cast<Index>(e)][0]);
      },
      surface.context());
  for (const auto& on : torn.on)
    for (const OnEdge& one : on) torn.vertices.push_back(one.vertex);
  std::sort(torn.vertices.begin(), torn.vertices.end());
  torn.vertices.erase(std::unique(torn.vertices.begin(), torn.vertices.end()), torn.vertices.end());
  return torn;
}

struct SplitCorner {
  Index vertex;
  EdgePoint value;
};

// Interpolates between two corner values that may be interpolated themselves.
EdgePoint value_at(const EdgePoint& a, const EdgePoint& b, double t) {
  if (a.from == a.to && b.from == b.to) return {a.from, b.from, t};
  if (a.from == b.from && a.to == b.to) return {a.from, a.to, (1 - t) * a.t + t * b.t};
  if (a.from == a.to && b.from == a.from) return {b.from, b.to, t * b.t};
  if (b.from == b.to && a.to == b.from) return {a.from, a.to, (1 - t) * a.t + t};
  return t <= 0.5 ? a : b;
}

// Splits a triangle with vertices on its sides into triangles, none of which has three corners on one side.
using SplitSide = std::vector<SplitCorner>;
void split_triangle(std::array<SplitCorner, 3> corner, std::array<SplitSide, 3> on,
                    std::vector<SplitCorner>& out) {
  for (int k = 0; k < 3 && on[0].empty(); ++k) {
    std::rotate(corner.begin(), corner.begin() + 1, corner.end());
    std::rotate(on.begin(), on.begin() + 1, on.end());
  }
  if (on[0].empty()) {
    out.insert(out.end(), corner.begin(), corner.end());
    return;
  }
  const auto middle = on[0].begin() + static_cast<std::ptrdiff_t>(on[0].size() / 2);
  split_triangle({corner[0], *middle, corner[2]}, {SplitSide(on[0].begin(), middle), SplitSide(), on[2]}, out);
  split_triangle({*middle, corner[1], corner[2]}, {SplitSide(middle + 1, on[0].end()), on[1], SplitSide()},
                 out);
}

}  // namespace

bool split_t_junctions(RepairSurface& surface, std::optional<double> distance) {
  const TornEdges torn = find_torn_edges(surface, weld_distance(surface, distance));
  if (torn.vertices.empty()) return false;
  const Faces& faces = surface.faces();
  const RepairFaces& traced = surface.traced();
  RepairFaces split;
  for (Index f = 0; f < faces.size(); ++f) {
    const Index first = faces.first_corner(f), n = static_cast<Index>(faces[f].size());
    std::vector<SplitCorner> corners;
    std::vector<SplitSide> on(n);
    bool whole = true;
    for (Index c = 0; c < n; ++c) {
      corners.push_back({faces[f][c], traced.corner[first + c]});
      const EdgePoint& next = traced.corner[first + (c + 1) % n];
      for (const OnEdge& vertex : torn.on[first + c])
        on[c].push_back({vertex.vertex, value_at(traced.corner[first + c], next, vertex.t)});
      whole = whole && on[c].empty();
    }
    if (whole) {
      split.keep(traced, f);
      continue;
    }
    std::vector<SplitCorner> pieces;
    if (n == 3) {
      split_triangle({corners[0], corners[1], corners[2]}, {on[0], on[1], on[2]}, pieces);
    } else {
      for (Index c = 0; c < n; ++c) {
        pieces.push_back(corners[c]);
        pieces.insert(pieces.end(), on[c].begin(), on[c].end());
      }
    }
    const std::size_t size = n == 3 ? 3 : pieces.size();
    for (std::size_t k = 0; k < pieces.size(); k += size) {
      std::vector<Index> face;
      std::vector<EdgePoint> values;
      for (std::size_t c = k; c < k + size; ++c) {
        face.push_back(pieces[c].vertex);
        values.push_back(pieces[c].value);
      }
      split.add(face, values, traced.origin[f], traced.is_new[f], traced.is_turned[f]);
    }
  }
  std::vector<Index> given;
  for (const Index v : torn.vertices)
    if (surface.vertex_origin(v) >= 0) given.push_back(surface.vertex_origin(v));
  surface.report(RepairChangeKind::split_t_junction, Domain::vertex, std::move(given),
                 static_cast<Index>(torn.vertices.size()));
  surface.replace_faces(std::move(split));
  return true;
}

}  // namespace meshgraft
