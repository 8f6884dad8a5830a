#include "support/graft_faults.h"

#include <algorithm>
#include <numeric>

#include <fmt/format.h>
#include <Eigen/Geometry>

#include <meshgraft/deform/quality.h>
#include <meshgraft/mesh/topology.h>

namespace meshgraft::test {

namespace {

void check_topology(const RandomGraft& graft, const MergeResult& result, std::vector<std::string>& faults) {
  const TopologySummary target = summarise_topology(graft.target), source = summarise_topology(graft.source),
                        after = summarise_topology(result.mesh);
  const auto pairs = static_cast<Index>(graft.pairs.size());
  const Index euler = target.euler_characteristic + source.euler_characteristic;
  const Index loops = target.boundary_loops + source.boundary_loops - 2 * pairs;
  if (!after.manifold) faults.emplace_back("not manifold");
  if (!after.oriented) faults.emplace_back("not oriented");
  if (after.euler_characteristic != euler)
    faults.push_back(fmt::format("Euler characteristic {} instead of {}", after.euler_characteristic, euler));
  if (after.boundary_loops != loops)
    faults.push_back(fmt::format("{} boundary loops instead of {}", after.boundary_loops, loops));
  if (after.closed != (loops == 0)) faults.emplace_back(loops == 0 ? "not closed" : "closed");
  if (pairs == 1 && after.components != target.components + source.components - 1)
    faults.push_back(fmt::format("{} components", after.components));
  if (after.isolated_vertices > target.isolated_vertices + source.isolated_vertices)
    faults.push_back(fmt::format("{} isolated vertices", after.isolated_vertices));
  const SeamReport& seam = result.report.seam;
  if (seam.manifold != after.manifold || seam.oriented != after.oriented || seam.closed != after.closed ||
      seam.euler_characteristic != after.euler_characteristic || seam.expected_euler_characteristic != euler)
    faults.emplace_back("the report's topology is not the mesh's");
}

/// Checks that target vertices are removed only near the loops, and that none outside the band moves by a bit.
void check_target(const RandomGraft& graft, const MergeResult& result, std::vector<std::string>& faults) {
  std::vector<Index> loops;
  for (const MergePair& pair : graft.pairs)
    loops.insert(loops.end(), pair.loops.target.begin(), pair.loops.target.end());
  const std::vector<Index> may_go =
      grow_rings(loops, 1, vertex_rings(graft.target.vertex_count(), graft.target.faces));
  if (result.target.new_index.size() != static_cast<std::size_t>(graft.target.vertex_count()))
    return faults.emplace_back("the target's vertex map has another length"), void();
  for (Index v = 0; v < graft.target.vertex_count(); ++v) {
    const Index now = result.target.new_index[v];
    if (now < 0) {
      if (!std::binary_search(may_go.begin(), may_go.end(), v))
        return faults.push_back(fmt::format("target vertex {} away from the loops is gone", v)), void();
    } else if (!std::binary_search(result.band.begin(), result.band.end(), now) &&
               result.mesh.positions.row(now) != graft.target.positions.row(v)) {
      return faults.push_back(fmt::format("target vertex {} outside the band moved", v)), void();
    }
  }
}

/// Counts triangles whose height is lost in the rounding of their positions.
Index degenerate_triangles(const Mesh& mesh) {
  constexpr double rounding = 1e-14;
  const Triangles triangles = triangulate(mesh).triangles;
  Index count = 0;
  for (Eigen::Index t = 0; t < triangles.rows(); ++t) {
    const Eigen::RowVector3d a = mesh.positions.row(triangles(t, 0)), b = mesh.positions.row(triangles(t, 1)),
                             c = mesh.positions.row(triangles(t, 2));
    const double longest = std::max({(b - a).squaredNorm(), (c - b).squaredNorm(), (a - c).squaredNorm()});
    count += !((b - a).cross(c - a).norm() > rounding * longest);
  }
  return count;
}

/// Checks that every input vertex becomes at most one vertex of the result, and no two become the same.
void check_maps(const RandomGraft& graft, const MergeResult& result, std::vector<std::string>& faults) {
  std::vector<int> uses(static_cast<std::size_t>(result.mesh.vertex_count()), 0);
  for (const IndexMap* map : {&result.target, &result.source}) {
    for (const Index v : map->new_index) {
      if (v >= result.mesh.vertex_count()) return faults.emplace_back("an index map leaves the mesh"), void();
      if (v >= 0 && ++uses[v] > 1) return faults.emplace_back("two vertices are mapped to one"), void();
    }
  }
  if (result.source.new_index.size() != static_cast<std::size_t>(graft.source.vertex_count()) ||
      std::any_of(result.source.new_index.begin(), result.source.new_index.end(),
                  [](Index v) { return v < 0; }))
    return faults.emplace_back("source vertices are gone"), void();
  for (Index v = 0; v < graft.source.vertex_count(); ++v) {
    const Index now = result.source.new_index[v];
    if (!std::binary_search(result.band.begin(), result.band.end(), now) &&
        result.mesh.positions.row(now) != result.grafted.row(v))
      return faults.push_back(fmt::format("source vertex {} outside the band is not where it was grafted", v)),
             void();
  }
}

}  // namespace

std::vector<std::string> faults_of(const RandomGraft& graft, const MergeResult& result) {
  std::vector<std::string> faults;
  if (!result.mesh.positions.allFinite() || !result.grafted.allFinite())
    faults.emplace_back("coordinates that are not finite");
  check_topology(graft, result, faults);
  check_target(graft, result, faults);
  check_maps(graft, result, faults);
  if (const Index now = degenerate_triangles(result.mesh),
      brought = degenerate_triangles(graft.target) + degenerate_triangles(graft.source);
      now > brought)
    faults.push_back(fmt::format("{} triangles without area", now - brought));
  for (const Attribute& attribute : result.mesh.attributes) {
    const Index count = attribute.domain == Domain::vertex ? result.mesh.vertex_count()
                        : attribute.domain == Domain::face ? result.mesh.face_count()
                                                           : result.mesh.faces.corner_count();
    if (attribute.values.size() != static_cast<std::size_t>(count) * attribute.components)
      faults.push_back(fmt::format("attribute {} has another length", attribute.name));
  }
  return faults;
}

namespace {

std::vector<Index> all_vertices(const Mesh& mesh) {
  std::vector<Index> vertices(static_cast<std::size_t>(mesh.vertex_count()));
  std::iota(vertices.begin(), vertices.end(), 0);
  return vertices;
}

Index self_intersection_count(const Mesh& mesh) {
  return static_cast<Index>(
      count_self_intersections(mesh.positions, triangulate(mesh).triangles, all_vertices(mesh)));
}

}  // namespace

Intersections intersections_of(const RandomGraft& graft, const MergeResult& result) {
  const Triangulation triangulation = triangulate(result.mesh);
  const auto pairs =
      self_intersections(result.mesh.positions, triangulation.triangles, all_vertices(result.mesh));
  Intersections found;
  const Index brought = self_intersection_count(graft.target) + self_intersection_count(graft.source);
  found.new_ones = std::max<Index>(0, static_cast<Index>(pairs.size()) - brought);
  const auto is_of_seam = [&](Index t) {
    return std::binary_search(result.new_faces.begin(), result.new_faces.end(), triangulation.face[t]);
  };
  found.of_seam = static_cast<Index>(std::count_if(pairs.begin(), pairs.end(), [&](const TrianglePair& pair) {
    return is_of_seam(pair[0]) || is_of_seam(pair[1]);
  }));
  return found;
}

}  // namespace meshgraft::test
