#include "refine_boundary.h"

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <map>
#include <numeric>
#include <utility>
#include <vector>

#include "mesh/refine.h"

namespace meshgraft {

namespace {

constexpr int neighbourhood_rings = 2;
constexpr int automatic_levels = 2;

// The holder of a vertex: the index of a handle, or one of these.
constexpr int outside = -4, nobody = -3, fixed = -2, constrained = -1;

// The vertices of a problem, as far as refinement depends on them.
struct BoundaryRoles {
  std::vector<int> holder;
  Flags refines;  ///< held vertices, around which the mesh is refined
  bool curves_stay = false;
};

std::vector<int> holders(const ResolvedProblem& problem) {
  const Region& region = problem.deform.region;
  std::vector<int> holder(problem.rest.rows(), region.whole ? nobody : outside);
  for (const Index v : region.vertices) holder[v] = nobody;
  for (const Index v : region.fixed) holder[v] = fixed;
  for (const VertexConstraint& constraint : problem.deform.constraints) holder[constraint.vertex] = constrained;
  for (std::size_t h = 0; h < region.handles.size(); ++h)
    for (const Index v : region.handles[h].vertices) holder[v] = static_cast<int>(h);
  return holder;
}

bool is_curve(const ResolvedProblem& problem, int holder) {
  return holder >= 0 && problem.deform.region.handles[holder].shape == HandleShape::curve;
}

// Calls `visit` with the corners of each triangle that joins free vertices with others.
template <class Visit>
void for_each_border_triangle(const Triangles& triangles, const std::vector<int>& holder, const Visit& visit) {
  for (Index t = 0; t < triangles.rows(); ++t) {
    const std::array<Index, 3> corners{triangles(t, 0), triangles(t, 1), triangles(t, 2)};
    const int free =
        (holder[corners[0]] == nobody) + (holder[corners[1]] == nobody) + (holder[corners[2]] == nobody);
    if (free == 1 || free == 2) visit(corners);
  }
}

// Returns the vertices that all handles but curves, and the constraints, hold.
std::vector<Index> held_vertices(const ResolvedProblem& problem) {
  std::vector<Index> held;
  for (const VertexConstraint& constraint : problem.deform.constraints) held.push_back(constraint.vertex);
  for (const Handle& handle : problem.deform.region.handles)
    if (handle.shape != HandleShape::curve)
      held.insert(held.end(), handle.vertices.begin(), handle.vertices.end());
  return held;
}

// Returns the pieces in which each vertex has a free neighbour, as lists of vertices.
std::vector<std::vector<Index>> sparse_pieces(const ResolvedProblem& problem, const std::vector<int>& holder) {
  std::vector<Index> held = held_vertices(problem);
  Flags is_rim(holder.size(), 0);
  for_each_border_triangle(problem.triangles, holder, [&](const std::array<Index, 3>& corners) {
    for (const Index v : corners) is_rim[v] = 1;
  });
  if (std::none_of(held.begin(), held.end(), [&](Index v) { return is_rim[v] != 0; })) return {};

  std::vector<Index> parent(holder.size());
  std::iota(parent.begin(), parent.end(), Index{0});
  const auto root = [&](Index v) {
    while (parent[v] != v) v = parent[v] = parent[parent[v]];
    return v;
  };
  for (Index t = 0; t < problem.triangles.rows(); ++t)
    for (int c = 0; c < 3; ++c) {
      const Index a = problem.triangles(t, c), b = problem.triangles(t, (c + 1) % 3);
      if (holder[a] >= constrained && holder[a] == holder[b]) parent[root(a)] = root(b);
    }
  Flags has_interior(holder.size(), 0);
  for (const Index v : held)
    if (!is_rim[v]) has_interior[root(v)] = 1;
  std::map<Index, std::vector<Index>> pieces;
  for (const Index v : held)
    if (!has_interior[root(v)]) pieces[root(v)].push_back(v);
  std::vector<std::vector<Index>> sparse;
  for (auto& [_, piece] : pieces) sparse.push_back(std::move(piece));
  return sparse;
}

// Returns the vertices of the smallest pieces, as long as they are few, so that refining around them adds few
// unknowns.
std::vector<Index> few_vertices(std::vector<std::vector<Index>> pieces, const std::vector<int>& holder) {
  constexpr std::ptrdiff_t few = 8, free_per_sparse = 100;
  const std::ptrdiff_t free = std::count(holder.begin(), holder.end(), nobody);
  const auto most = static_cast<std::size_t>(std::max(few, free / free_per_sparse));
  const auto size = [](const std::vector<Index>& piece) { return piece.size(); };
  std::ranges::stable_sort(pieces, {}, size);
  std::vector<Index> vertices;
  for (std::size_t first = 0; first < pieces.size();) {  // all pieces of a size, or none
    std::size_t last = first, total = vertices.size();
    for (; last < pieces.size() && pieces[last].size() == pieces[first].size(); ++last)
      total += pieces[last].size();
    if (total > most) break;
    for (; first < last; ++first) vertices.insert(vertices.end(), pieces[first].begin(), pieces[first].end());
  }
  return vertices;
}

// Returns, per vertex, whether it is within some rings of a held vertex that has a free neighbour and around
// which the mesh is refined.
Flags boundary_neighbourhood(const Triangles& triangles, const BoundaryRoles& roles) {
  constexpr std::uint8_t far = neighbourhood_rings + 1;
  std::vector<std::uint8_t> ring(roles.holder.size(), far);
  for_each_border_triangle(triangles, roles.holder, [&](const std::array<Index, 3>& corners) {
    for (const Index v : corners)
      if (roles.refines[v]) ring[v] = 0;
  });
  for (std::uint8_t r = 0; r < neighbourhood_rings; ++r)
    for (Index t = 0; t < triangles.rows(); ++t) {
      std::uint8_t* corners[] = {&ring[triangles(t, 0)], &ring[triangles(t, 1)], &ring[triangles(t, 2)]};
      if (*corners[0] > r && *corners[1] > r && *corners[2] > r) continue;
      for (std::uint8_t* corner : corners) *corner = std::min<std::uint8_t>(*corner, r + 1);
    }
  Flags near(ring.size(), 0);
  for (std::size_t v = 0; v < ring.size(); ++v) near[v] = ring[v] < far;
  return near;
}

// The triangles that have split edges, and their pieces, as a mesh of their own.
struct LocalRefinement {
  std::vector<Index> triangles, vertices;  ///< those of the whole mesh, ascending
  RefineResult refined;
};

// Splits the edges within the neighbourhood of the held vertices around which the mesh is refined.
LocalRefinement split_locally(const ResolvedProblem& problem, const BoundaryRoles& roles,
                              const Context& context) {
  LocalRefinement split;
  const Flags near = boundary_neighbourhood(problem.triangles, roles);
  std::vector<Index> local(near.size(), -1);
  for (Index t = 0; t < problem.triangles.rows(); ++t) {
    const Index a = problem.triangles(t, 0), b = problem.triangles(t, 1), c = problem.triangles(t, 2);
    if (near[a] + near[b] + near[c] < 2) continue;
    split.triangles.push_back(t);
    for (const Index v : {a, b, c}) local[v] = 0;
  }
  for (std::size_t v = 0; v < local.size(); ++v)
    if (local[v] == 0) {
      local[v] = static_cast<Index>(split.vertices.size());
      split.vertices.push_back(static_cast<Index>(v));
    }
  Triangles triangles = problem.triangles(split.triangles, Eigen::all);
  for (Index& v : triangles.reshaped()) v = local[v];

  const auto is_split = [&](Index low, Index high) {
    const Index a = split.vertices[low], b = split.vertices[high];
    const bool on_curve = roles.holder[a] == roles.holder[b] && is_curve(problem, roles.holder[a]);
    return near[a] && near[b] && !(roles.curves_stay && on_curve);
  };
  split.refined =
      split_edges(make_mesh(problem.rest(split.vertices, Eigen::all), triangles), is_split, context);
  return split;
}

// Returns the triangles with each split one replaced by its pieces. New vertices follow `old_count` others.
Triangles with_pieces(const Triangles& triangles, const LocalRefinement& split, Index old_count) {
  const Faces& pieces = split.refined.mesh.faces;
  const auto known = static_cast<Index>(split.vertices.size());
  Triangles result(triangles.rows() + pieces.size() - static_cast<Index>(split.triangles.size()), 3);
  Index row = 0, next = 0, piece = 0;
  const auto copy_up_to = [&](Index end) {
    result.middleRows(row, end - next) = triangles.middleRows(next, end - next);
    row += end - next;
    next = end;
  };
  for (Index k = 0; k < static_cast<Index>(split.triangles.size()); ++k) {
    copy_up_to(split.triangles[k]);
    ++next;
    for (; piece < pieces.size() && split.refined.face_parent[piece] == k; ++piece, ++row)
      for (int c = 0; c < 3; ++c) {
        const Index v = pieces[piece][c];
        result(row, c) = v < known ? split.vertices[v] : old_count + v - known;
      }
  }
  copy_up_to(static_cast<Index>(triangles.rows()));
  return result;
}

// Inserts new vertices between consecutive vertices of a curve handle, both into the handle and into its
// redrawn course.
void refine_curve(Handle& handle, HandlePose& pose, const std::map<std::array<Index, 2>, Index>& middle) {
  std::vector<Index> vertices;
  std::vector<Eigen::RowVector3d> course;
  const std::size_t count = handle.vertices.size();
  for (std::size_t i = 0; i < count; ++i) {
    const std::size_t next = (i + 1) % count;
    vertices.push_back(handle.vertices[i]);
    if (pose.curve) course.emplace_back(pose.curve->row(static_cast<Eigen::Index>(i)));
    if (next == 0 && !handle.closed) break;
    const auto [low, high] = std::minmax(handle.vertices[i], handle.vertices[next]);
    const auto between = middle.find({low, high});
    if (between == middle.end()) continue;
    vertices.push_back(between->second);
    if (pose.curve)
      course.emplace_back(
          (pose.curve->row(static_cast<Eigen::Index>(i)) + pose.curve->row(static_cast<Eigen::Index>(next))) /
          2);
  }
  handle.vertices = std::move(vertices);
  if (!pose.curve) return;
  pose.curve->resize(static_cast<Eigen::Index>(course.size()), 3);
  for (std::size_t i = 0; i < course.size(); ++i) pose.curve->row(static_cast<Eigen::Index>(i)) = course[i];
}

bool stays(int holder) { return holder == fixed || holder == outside; }

// Returns the holder of a new vertex between two others.
int holder_between(const ResolvedProblem& problem, int one, int other) {
  if (one == outside && other == outside) return outside;
  if (stays(one) && stays(other)) return fixed;
  const bool same = one == other && one >= 0;
  return same && problem.deform.region.handles[one].shape == HandleShape::region ? one : nobody;
}

void refine_once(ResolvedProblem& problem, BoundaryRoles& roles, const Context& context) {
  const auto old_count = static_cast<Index>(problem.rest.rows());
  const LocalRefinement split = split_locally(problem, roles, context);
  const auto added = static_cast<Index>(split.refined.parents.size());
  problem.triangles = with_pieces(problem.triangles, split, old_count);
  problem.rest.conservativeResize(old_count + added, 3);
  problem.rest.bottomRows(added) = split.refined.mesh.positions.bottomRows(added);

  Region& region = problem.deform.region;
  std::vector<int> feature(old_count, -1);
  for (std::size_t f = 0; f < region.features.size(); ++f)
    for (const Index v : region.features[f].vertices) feature[v] = static_cast<int>(f);
  std::map<std::array<Index, 2>, Index> middle;
  for (Index i = 0; i < added; ++i) {
    const Index vertex = old_count + i;
    const auto [low, high] = split.refined.parents[i];
    const Index a = split.vertices[low], b = split.vertices[high];
    middle[{a, b}] = vertex;
    const int holder = holder_between(problem, roles.holder[a], roles.holder[b]);
    roles.holder.push_back(holder);
    roles.refines.push_back(holder != nobody && roles.refines[a] && roles.refines[b]);
    if (holder == outside) continue;
    if (!region.whole) region.vertices.push_back(vertex);
    if (holder == fixed) region.fixed.push_back(vertex);
    if (holder >= 0) region.handles[holder].vertices.push_back(vertex);
    if (feature[a] >= 0 && feature[a] == feature[b]) region.features[feature[a]].vertices.push_back(vertex);
  }
  for (std::size_t h = 0; h < region.handles.size() && !roles.curves_stay; ++h)
    if (region.handles[h].shape == HandleShape::curve)
      refine_curve(region.handles[h], problem.deform.poses[h], middle);
}

}  // namespace

ResolvedProblem refine_boundary(ResolvedProblem problem, std::optional<int> levels, const Context& context) {
  if (levels == 0) return problem;
  BoundaryRoles roles{holders(problem)};
  if (levels) {
    for (const int holder : roles.holder) roles.refines.push_back(holder != nobody);
  } else {
    const std::vector<Index> sparse = few_vertices(sparse_pieces(problem, roles.holder), roles.holder);
    if (sparse.empty()) return problem;
    roles.curves_stay = true;
    roles.refines.assign(roles.holder.size(), 0);
    for (const Index v : sparse) roles.refines[v] = 1;
  }
  const int count = levels.value_or(automatic_levels);
  for (int level = 0; level < count; ++level) {
    context.step("refine", static_cast<double>(level) / count);
    refine_once(problem, roles, context);
  }
  return problem;
}

}  // namespace meshgraft
