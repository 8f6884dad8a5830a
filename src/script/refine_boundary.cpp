#include "refine_boundary.h"

#include <algorithm>
#include <array>
#include <map>
#include <utility>

#include <meshgraft/mesh/topology.h>

#include "mesh/refine.h"

namespace meshgraft {

namespace {

constexpr int neighbourhood_rings = 2;

// The holder of a vertex: the index of a handle, or one of these.
constexpr int outside = -4, nobody = -3, fixed = -2, constrained = -1;

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

// Returns the vertices around each held vertex that has a free neighbour.
std::vector<Index> boundary_neighbourhood(const std::vector<int>& holder, const IndexLists& rings) {
  std::vector<Index> seeds;
  for (Index v = 0; v < rings.size(); ++v) {
    const auto ring = rings[v];
    const bool held = holder[v] != nobody;
    if (held && std::any_of(ring.begin(), ring.end(), [&](Index w) { return holder[w] == nobody; }))
      seeds.push_back(v);
  }
  return grow_rings(seeds, neighbourhood_rings, rings);
}

bool stays(int holder) { return holder == fixed || holder == outside; }

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

ResolvedProblem refine_once(ResolvedProblem problem, const Context& context) {
  const auto old_count = static_cast<Index>(problem.rest.rows());
  const std::vector<int> holder = holders(problem);
  const IndexLists rings = vertex_rings(old_count, problem.triangles, context);
  const std::vector<Index> around = boundary_neighbourhood(holder, rings);
  const RefineResult refined = split_edges_within(make_mesh(problem.rest, problem.triangles), around, context);
  problem.rest = refined.mesh.positions;
  problem.triangles = triangulate(refined.mesh, {.skip_out_of_range = true}).triangles;

  Region& region = problem.deform.region;
  std::vector<int> feature(old_count, -1);
  for (std::size_t f = 0; f < region.features.size(); ++f)
    for (const Index v : region.features[f].vertices) feature[v] = static_cast<int>(f);
  std::map<std::array<Index, 2>, Index> middle;
  for (std::size_t i = 0; i < refined.parents.size(); ++i) {
    const Index vertex = old_count + static_cast<Index>(i);
    const auto [a, b] = std::minmax(refined.parents[i][0], refined.parents[i][1]);
    middle[{a, b}] = vertex;
    const int one = holder[a], other = holder[b];
    if (one == outside && other == outside) continue;
    if (!region.whole) region.vertices.push_back(vertex);
    if (stays(one) && stays(other)) region.fixed.push_back(vertex);
    if (one >= 0 && one == other && region.handles[one].shape == HandleShape::region)
      region.handles[one].vertices.push_back(vertex);
    if (feature[a] >= 0 && feature[a] == feature[b]) region.features[feature[a]].vertices.push_back(vertex);
  }
  for (std::size_t h = 0; h < region.handles.size(); ++h)
    if (region.handles[h].shape == HandleShape::curve)
      refine_curve(region.handles[h], problem.deform.poses[h], middle);
  return problem;
}

}  // namespace

ResolvedProblem refine_boundary(ResolvedProblem problem, int levels, const Context& context) {
  for (int level = 0; level < levels; ++level) {
    context.step("refine", static_cast<double>(level) / levels);
    problem = refine_once(std::move(problem), context);
  }
  return problem;
}

}  // namespace meshgraft
