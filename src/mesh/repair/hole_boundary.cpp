#include "hole_boundary.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <ranges>
#include <utility>

#include <Eigen/Geometry>

#include <meshgraft/mesh/topology.h>

#include "mesh/coincident.h"

namespace meshgraft {

HoleBoundary::HoleBoundary(const RepairSurface& surface, const RepairOptions& options)
    : surface_(surface),
      leaving_(surface.mesh().vertex_count(), none),
      arriving_(surface.mesh().vertex_count(), none) {
  const EdgeTable& table = surface.edges();
  const std::vector<Index>& corners = surface.faces().corners();
  bool is_open = false;
  for (Index c = 0; c < static_cast<Index>(corners.size()); ++c) {
    if (table.next[c] < 0 || !table.is_boundary(c)) continue;
    is_open = true;
    Index& from = leaving_[corners[c]];
    Index& to = arriving_[corners[table.next[c]]];
    from = from == none ? c : several;
    to = to == none ? c : several;
  }
  if (!is_open) return;
  vertex_loops_ = boundary_loops(surface.mesh());
  find_positions(options);
  cross_gaps();
}

// Without welding only the copies of one given vertex share a position.
void HoleBoundary::find_positions(const RepairOptions& options) {
  if (options.weld) {
    position_ = boundary_positions(surface_, options.weld_distance);
    return;
  }
  position_.assign(leaving_.size(), none);
  std::vector<Index> first(leaving_.size(), none);
  for (const Index v : boundary_vertices(surface_.mesh().vertex_count(), surface_.edges())) {
    const Index origin = surface_.vertex_origin(v);
    if (origin >= 0 && first[origin] < 0) first[origin] = v;
    position_[v] = origin < 0 ? v : first[origin];
  }
}

void HoleBoundary::cross_gaps() {
  across_.resize(position_.size());
  std::iota(across_.begin(), across_.end(), 0);
  std::vector<std::pair<Index, Index>> at_position;
  for (Index v = 0; v < static_cast<Index>(position_.size()); ++v)
    if (position_[v] >= 0) at_position.emplace_back(position_[v], v);
  std::sort(at_position.begin(), at_position.end());
  for (auto begin = at_position.begin(); begin != at_position.end();) {
    const auto end =
        std::find_if(begin, at_position.end(), [&](const auto& at) { return at.first != begin->first; });
    std::vector<Index> fans;
    for (const auto& [position, v] : std::ranges::subrange(begin, end)) fans.push_back(v);
    if (fans.size() > 1) order_fans(fans);
    begin = end;
  }
}

// Orders the fans at a position around it, so that each one's gap ends at the next. Changes nothing unless all
// fans face the same side.
void HoleBoundary::order_fans(std::span<const Index> fans) {
  constexpr double least_cosine = 0.5;  // between a fan's normal and the mean
  const auto is_simple = [&](Index v) { return leaving_[v] >= 0 && arriving_[v] >= 0; };
  if (!std::ranges::all_of(fans, is_simple)) return;
  std::vector<Eigen::RowVector3d> normals;
  Eigen::RowVector3d mean = Eigen::RowVector3d::Zero();
  for (const Index v : fans) {
    normals.push_back((surface_.face_normal(surface_.face_of(leaving_[v])) +
                       surface_.face_normal(surface_.face_of(arriving_[v])))
                          .normalized());
    mean += normals.back();
  }
  mean.normalize();
  if (!std::ranges::all_of(normals, [&](const auto& normal) { return normal.dot(mean) >= least_cosine; }))
    return;
  const Eigen::RowVector3d axis = mean.unitOrthogonal(), third = mean.cross(axis);
  std::vector<std::pair<double, Index>> around;
  for (const Index v : fans) {
    const Index ahead = surface_.faces().corners()[surface_.edges().next[leaving_[v]]];
    const Eigen::RowVector3d along = surface_.positions().row(ahead) - surface_.positions().row(v);
    around.emplace_back(std::atan2(along.dot(third), along.dot(axis)), v);
  }
  std::sort(around.begin(), around.end());
  for (std::size_t k = 0; k < around.size(); ++k)
    across_[around[k].second] = around[(k + 1) % around.size()].second;
}

std::vector<std::vector<Index>> HoleBoundary::loops(Index most_edges, Index& unsound) const {
  const EdgeTable& table = surface_.edges();
  const std::vector<Index>& corners = surface_.faces().corners();
  std::vector<std::vector<Index>> loops;
  for (const std::vector<Index>& vertices : vertex_loops_) {
    std::vector<Index> loop;
    bool sound = true;
    for (std::size_t k = 0; k < vertices.size() && sound; ++k) {
      loop.push_back(leaving_[vertices[k]]);
      sound = loop[k] >= 0 && corners[table.next[loop[k]]] == vertices[(k + 1) % vertices.size()];
    }
    if (sound)
      loops.push_back(std::move(loop));
    else
      unsound += static_cast<Index>(vertices.size()) <= most_edges;
  }
  return loops;
}

std::vector<std::vector<Index>> HoleBoundary::touching_loops() const {
  const EdgeTable& table = surface_.edges();
  const std::vector<Index>& corners = surface_.faces().corners();
  std::vector<std::vector<Index>> loops;
  if (vertex_loops_.empty()) return loops;
  Flags visited(corners.size(), 0);
  for (Index first = 0; first < static_cast<Index>(corners.size()); ++first) {
    if (table.next[first] < 0 || !table.is_boundary(first)) continue;
    std::vector<Index> loop;
    bool touches = false;
    Index half_edge = first;
    while (half_edge >= 0 && !visited[half_edge]) {
      visited[half_edge] = 1;
      loop.push_back(half_edge);
      const Index end = corners[table.next[half_edge]];
      touches = touches || across_[end] != end;
      half_edge = leaving_[across_[end]];
    }
    if (!touches || half_edge != first) continue;
    for (std::vector<Index>& simple : simple_loops(loop)) loops.push_back(std::move(simple));
  }
  return loops;
}

// Splits a loop at positions that it passes more than once.
std::vector<std::vector<Index>> HoleBoundary::simple_loops(const std::vector<Index>& loop) const {
  std::vector<std::vector<Index>> loops;
  std::vector<Index> rest;
  for (const Index half_edge : loop) {
    const auto before =
        std::ranges::find(rest, position_of(half_edge), [&](Index c) { return position_of(c); });
    if (rest.end() - before > 2) {
      loops.emplace_back(before, rest.end());
      rest.erase(before, rest.end());
    }
    rest.push_back(half_edge);
  }
  if (rest.size() > 2) loops.push_back(std::move(rest));
  return loops;
}

}  // namespace meshgraft
