#include "graft_meshes.h"

#include <limits>
#include <utility>

#include <meshgraft/mesh/normals.h>

#include "boundary_condition.h"
#include "core/stopwatch.h"
#include "pose_by_boundary.h"
#include "report_pair.h"
#include "seam_faults.h"

namespace meshgraft {

namespace {

/// Returns the positions that the vertices of a seam's mesh had in the target and the source.
Points positions_at_rest(const SeamResult& seam, const Mesh& target, const Mesh& source) {
  Points rest = Points::Constant(seam.mesh.vertex_count(), 3, std::numeric_limits<double>::quiet_NaN());
  const auto take = [&](const IndexMap& map, const Points& positions) {
    for (std::size_t v = 0; v < map.new_index.size(); ++v)
      if (map.new_index[v] >= 0 && static_cast<Eigen::Index>(v) < positions.rows())
        rest.row(map.new_index[v]) = positions.row(static_cast<Eigen::Index>(v));
  };
  take(seam.target, target.positions);
  take(seam.source, source.positions);
  return rest;
}

}  // namespace

GraftedSource graft_source(const MatchedMeshes& matched, std::span<const Correspondence> correspondences,
                           const MergeOptions& options, int fewest_doublings, const Context& context) {
  Stopwatch watch;
  const RefinedSource& source = matched.source;
  const bool found = options.pose == MergePose::find;
  std::vector<PairGeometry> geometry = matched.geometry;
  const Points posed = found ? pose_by_boundary(source.mesh.positions, matched.component, geometry,
                                                correspondences, options.size)
                             : source.mesh.positions;
  GraftedSource grafted;
  std::vector<VertexConstraint> constraints;
  for (std::size_t p = 0; p < geometry.size(); ++p) {
    BoundaryOptions boundary{options.pose, {}, options.normal_angle_deg};
    if (options.size) boundary.scale = found ? 1 : *options.size;
    const auto held = boundary_constraints(source.pairs[p], geometry[p].source, geometry[p].target,
                                           correspondences[p], boundary);
    grafted.misfits_rel.push_back(misfit_rel(geometry[p].source.points, held));
    constraints.insert(constraints.end(), held.begin(), held.end());
  }
  const Triangles triangles = triangulate(source.mesh, {.skip_out_of_range = true}).triangles;
  grafted.found =
      graft_within_radius({source.mesh.positions, posed, triangles, matched.component, source.pairs},
                          constraints, options, fewest_doublings, context);
  grafted.seconds = watch.seconds();
  return grafted;
}

SeamResult join_source(const MatchedMeshes& matched, const GraftedSource& grafted, const MergeOptions& options,
                       const Context& context) {
  const Mesh& source = matched.source.mesh;
  Mesh moved = source;
  moved.positions = grafted.found.graft.positions;
  update_normals(moved, source.positions);
  SeamResult seam = make_seam(matched.target, moved, matched.source.pairs, options.seam, context);
  const SeamLayout layout{.target_vertices = seam.mesh.vertex_count() - source.vertex_count(),
                          .target_faces = seam.new_faces.front() - source.face_count(),
                          .source_faces = source.face_count()};
  seam.report.faults =
      find_seam_faults({seam.mesh, layout, positions_at_rest(seam, matched.target, source)}, context);
  return seam;
}

}  // namespace meshgraft
