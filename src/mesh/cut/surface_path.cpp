#include "surface_path.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <unordered_map>
#include <utility>

#include <meshgraft/core/error.h>

#include "mesh/area_vector.h"
#include "mesh/facts.h"
#include "mesh/shortest_distances.h"

namespace meshgraft {

namespace {

constexpr double shorter_rel = 1 - 1e-12;  // factor below which a length counts as shorter
constexpr double at_end = 1e-6;            // a crossing this near to an end of its edge is at that end

}  // namespace

// A turn of the path: a vertex on the border of the strip, at an end of the half-edge `strip[portal]`.
struct SurfacePaths::Turn {
  Index vertex = 0;
  std::size_t portal = 0;
};

struct SurfacePaths::Path {
  double length = 0;
  std::vector<Turn> turns;
  std::vector<EdgePoint> points;
};

SurfacePaths::SurfacePaths(const Points& positions, const Faces& triangles, const EdgeTable& table)
    : positions_(positions),
      triangles_(triangles),
      table_(table),
      corner_at_(positions.rows(), -1),
      next_at_(triangles.corner_count(), -1) {
  for (Index f = 0; f < triangles.size(); ++f) face_.insert(face_.end(), triangles[f].size(), f);
  for (Index c = triangles.corner_count() - 1; c >= 0; --c)
    if (table.next[c] >= 0) next_at_[c] = std::exchange(corner_at_[vertex(c)], c);
}

// Returns the half-edge along the same edge in the neighbouring face. Returns -1 without exactly one,
// consistently oriented neighbour.
Index SurfacePaths::twin(Index half_edge) const {
  const auto along = table_.half_edges[table_.edge[half_edge]];
  if (along.size() != 2) return -1;
  const Index other = along[0] == half_edge ? along[1] : along[0];
  return vertex(other) == vertex(half_edge) ? -1 : other;
}

bool SurfacePaths::face_has(Index half_edge, Index v) const {
  return vertex(half_edge) == v || vertex(table_.next[half_edge]) == v ||
         vertex(table_.previous[half_edge]) == v;
}

// Runs Dijkstra's algorithm from triangle to triangle, through the midpoints of their edges.
SurfacePaths::Strip SurfacePaths::first_strip(Index from, Index to, const Context& context) const {
  SparseDistances distance;
  std::unordered_map<Index, Index> entered_over;  // per face: half-edge crossed into it, in the face before
  std::vector<Index> around;                      // the faces at `from`
  for (Index c = corner_at_[from]; c >= 0; c = next_at_[c]) around.push_back(face_[c]);
  const auto middle = [&](Index half_edge) -> Eigen::RowVector3d {
    return (positions_.row(vertex(half_edge)) + positions_.row(vertex(table_.next[half_edge]))) / 2;
  };
  Index last = -1;  // the face at `to` that is reached first
  std::size_t steps = 0;
  shortest_distances(around, distance, [&](Index face, double reached, const auto& offer) {
    if (steps++ % 4096 == 0) context.throw_if_stopped();
    const Index first = triangles_.first_corner(face);
    if (face_has(first, to)) {
      last = face;
      return false;
    }
    const auto entry = entered_over.find(face);
    const Eigen::RowVector3d here = entry == entered_over.end() ? positions_.row(from) : middle(entry->second);
    for (Index c = first; c < first + 3; ++c) {
      const Index other = twin(c);
      if (other >= 0 && offer(face_[other], reached + (middle(c) - here).norm()))
        entered_over[face_[other]] = c;
    }
    return true;
  });
  if (last < 0) throw Error(facts::mesh::NoPath{.from = from, .to = to});

  Strip strip;
  for (auto over = entered_over.find(last); over != entered_over.end();
       over = entered_over.find(face_[over->second]))
    strip.push_back(over->second);
  std::reverse(strip.begin(), strip.end());
  return strip;
}

// Removes detours that return to an earlier triangle of the strip, and the triangles at its ends that lie
// around the end vertices.
void SurfacePaths::remove_detours(Strip& strip, Index from, Index to) const {
  Strip kept;
  std::unordered_map<Index, std::size_t>
      crossed_before;  // per face: how many half-edges were crossed before it
  const auto enter = [&](Index face) {
    if (const auto seen = crossed_before.find(face); seen != crossed_before.end()) {
      for (std::size_t k = seen->second; k < kept.size(); ++k) crossed_before.erase(face_[twin(kept[k])]);
      kept.resize(seen->second);
    }
    crossed_before[face] = kept.size();
  };
  if (!strip.empty()) enter(face_[strip.front()]);
  for (const Index half_edge : strip) {
    kept.push_back(half_edge);
    enter(face_[twin(half_edge)]);
  }
  std::size_t begin = 0, end = 0;
  for (std::size_t k = 0; k < kept.size(); ++k)
    if (face_has(twin(kept[k]), from)) begin = k + 1;
  for (end = begin; end < kept.size() && !face_has(kept[end], to);) ++end;
  strip.assign(kept.begin() + static_cast<std::ptrdiff_t>(begin),
               kept.begin() + static_cast<std::ptrdiff_t>(end));
}

// Returns the strip rerouted around the other side of a vertex on its border, or an empty one if a boundary
// is in the way.
SurfacePaths::Strip SurfacePaths::around_other_side(const Strip& strip, const Turn& turn) const {
  const Index v = turn.vertex;
  const auto touches = [&](Index half_edge) {
    return vertex(half_edge) == v || vertex(table_.next[half_edge]) == v;
  };
  std::size_t first = turn.portal, last = turn.portal;
  while (first > 0 && touches(strip[first - 1])) --first;
  while (last + 1 < strip.size() && touches(strip[last + 1])) ++last;

  Strip result(strip.begin(), strip.begin() + static_cast<std::ptrdiff_t>(first));
  const Index goal = face_[twin(strip[last])];
  const bool turns_left = vertex(strip[first]) == v;  // one of the face's edges at v begins there
  for (Index half_edge = strip[first];;) {
    half_edge = turns_left ? table_.previous[half_edge] : table_.next[half_edge];
    const Index other = twin(half_edge);
    if (other < 0 || result.size() > strip.size() + face_.size()) return {};
    result.push_back(half_edge);
    if (face_[other] == goal) break;
    half_edge = other;
  }
  result.insert(result.end(), strip.begin() + static_cast<std::ptrdiff_t>(last) + 1, strip.end());
  return result;
}

// Unfolds the strip and finds the shortest path within it by the funnel algorithm (Lee and Preparata 1984).
SurfacePaths::Path SurfacePaths::shortest_within(const Strip& strip, Index from, Index to) const {
  struct FunnelPoint {
    Index vertex;
    Eigen::Vector2d at;
  };
  std::vector<FunnelPoint> left, right;
  const auto distance = [&](Index a, Index b) { return (positions_.row(a) - positions_.row(b)).norm(); };
  // Returns the coordinates of x beyond the directed edge from a to b, to its right.
  const auto unfold = [&](const FunnelPoint& a, const FunnelPoint& b, Index x) -> FunnelPoint {
    const Eigen::RowVector3d edge = positions_.row(b.vertex) - positions_.row(a.vertex);
    const Eigen::RowVector3d offset = positions_.row(x) - positions_.row(a.vertex);
    const double length = edge.norm();
    const double along = length > 0 ? offset.dot(edge) / length : 0;
    const double height = std::sqrt(std::max(0.0, offset.squaredNorm() - along * along));
    const Eigen::Vector2d u = length > 0 ? Eigen::Vector2d((b.at - a.at).normalized()) : Eigen::Vector2d(1, 0);
    return {x, a.at + along * u + height * Eigen::Vector2d(u.y(), -u.x())};
  };

  // Seen along the strip, a half-edge begins at its right end.
  const Index c = strip.front();
  FunnelPoint r{vertex(c), {0, 0}}, l{vertex(table_.next[c]), {distance(vertex(c), vertex(table_.next[c])), 0}};
  const FunnelPoint start{from, unfold(l, r, from).at};
  for (std::size_t k = 0; k < strip.size(); ++k) {
    right.push_back(r);
    left.push_back(l);
    const Index other = twin(strip[k]);
    const FunnelPoint beyond = unfold(r, l, vertex(table_.previous[other]));
    if (k + 1 == strip.size()) {
      left.push_back({to, beyond.at});
      right.push_back({to, beyond.at});
    } else if (strip[k + 1] == table_.next[other]) {  // from the right end to the new vertex
      l = beyond;
    } else {
      r = beyond;
    }
  }

  Path path;
  FunnelPoint apex = start;
  std::ptrdiff_t apex_portal = -1;
  const auto finish_segment = [&](const FunnelPoint& end, std::ptrdiff_t portal) {
    for (std::ptrdiff_t k = apex_portal + 1; k < portal; ++k) {
      const FunnelPoint &p = left[k], &q = right[k];
      const auto is_end = [&](Index v) { return v == apex.vertex || v == end.vertex; };
      if (is_end(p.vertex) || is_end(q.vertex)) continue;
      const Eigen::Vector2d d = end.at - apex.at;
      const double a = cross(d, p.at - apex.at), b = cross(d, q.at - apex.at);
      const double t = a != b ? std::clamp(a / (a - b), 0.0, 1.0) : 0.5;  // from p to q
      if (t < at_end) {
        path.points.push_back({p.vertex, p.vertex, 0});
      } else if (t > 1 - at_end) {
        path.points.push_back({q.vertex, q.vertex, 0});
      } else {
        path.points.push_back(p.vertex < q.vertex ? EdgePoint{p.vertex, q.vertex, t}
                                                  : EdgePoint{q.vertex, p.vertex, 1 - t});
      }
    }
    path.length += (end.at - apex.at).norm();
    if (end.vertex == to && portal == static_cast<std::ptrdiff_t>(strip.size())) return;
    path.points.push_back({end.vertex, end.vertex, 0});
    path.turns.push_back({end.vertex, static_cast<std::size_t>(portal)});
  };

  const auto portals = static_cast<std::ptrdiff_t>(left.size());
  FunnelPoint funnel_left = left[0], funnel_right = right[0];
  std::ptrdiff_t at_left = 0, at_right = 0;
  const auto restart_at = [&](const FunnelPoint& point, std::ptrdiff_t portal) {
    finish_segment(point, portal);
    apex = funnel_left = funnel_right = point;
    apex_portal = at_left = at_right = portal;
  };
  for (std::ptrdiff_t k = 1; k < portals; ++k) {
    if (cross(funnel_right.at - apex.at, right[k].at - apex.at) >= 0) {
      if (apex.vertex == funnel_right.vertex || cross(funnel_left.at - apex.at, right[k].at - apex.at) < 0) {
        funnel_right = right[k];
        at_right = k;
      } else {
        restart_at(funnel_left, at_left);
        k = apex_portal;
        continue;
      }
    }
    if (cross(funnel_left.at - apex.at, left[k].at - apex.at) <= 0) {
      if (apex.vertex == funnel_left.vertex || cross(funnel_right.at - apex.at, left[k].at - apex.at) > 0) {
        funnel_left = left[k];
        at_left = k;
      } else {
        restart_at(funnel_right, at_right);
        k = apex_portal;
        continue;
      }
    }
  }
  if (apex_portal < portals - 1) finish_segment(left.back(), portals - 1);
  return path;
}

std::vector<EdgePoint> SurfacePaths::between(Index from, Index to, const Context& context) const {
  Strip strip = first_strip(from, to, context);
  remove_detours(strip, from, to);
  if (strip.empty()) return {};
  Path path = shortest_within(strip, from, to);
  for (bool shorter = true; shorter;) {
    shorter = false;
    context.throw_if_stopped();
    for (const Turn& turn : path.turns) {
      Strip other = around_other_side(strip, turn);
      if (other.empty()) continue;
      remove_detours(other, from, to);
      if (other.empty()) return {};
      Path candidate = shortest_within(other, from, to);
      if (!(candidate.length < shorter_rel * path.length)) continue;
      strip = std::move(other);
      path = std::move(candidate);
      shorter = true;
      break;
    }
  }
  return path.points;
}

}  // namespace meshgraft
