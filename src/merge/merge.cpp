#include <meshgraft/merge/merge.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include <meshgraft/core/error.h>
#include <meshgraft/mesh/cut.h>
#include <meshgraft/mesh/normals.h>
#include <meshgraft/mesh/topology.h>

#include "boundary_condition.h"
#include "core/stopwatch.h"
#include "graft_within_radius.h"
#include "loops.h"
#include "match_by_arc_length.h"
#include "match_loops.h"
#include "merge/facts.h"
#include "merge_notes.h"
#include "mesh/winding.h"
#include "pose_by_boundary.h"
#include "refine_source.h"
#include "report_pair.h"
#include "seam.h"
#include "validate_options.h"

namespace meshgraft {

namespace {

/// Returns the source, turned over where it is oriented inconsistently with the target.
Mesh oriented_as_target(const Mesh& source, const Mesh& target, bool may_turn) {
  if (!windings_disagree(target, source)) return source;
  if (may_turn) return turned_over(source);
  const bool target_inward = enclosed_volume(target) < 0;
  throw Error(facts::merge::OrientationsDisagree{
      .inward = target_inward ? facts::merge::Side::target : facts::merge::Side::source,
      .outward = target_inward ? facts::merge::Side::source : facts::merge::Side::target});
}

/// Removes stored cut normals of loops that are no longer open.
void drop_used_cut_normals(Mesh& mesh) {
  const auto kept =
      std::find_if(mesh.attributes.begin(), mesh.attributes.end(), [](const Attribute& attribute) {
        return attribute.domain == Domain::vertex && attribute.name == cut_normal_name;
      });
  if (kept == mesh.attributes.end()) return;
  Flags open(mesh.vertex_count(), 0);
  for (const auto& loop : boundary_loops(mesh))
    for (const Index v : loop) open[v] = 1;
  bool used = false;
  for (std::size_t k = 0; k < kept->values.size(); ++k) {
    if (!open[k / kept->components]) kept->values[k] = std::numeric_limits<double>::quiet_NaN();
    used |= std::isfinite(kept->values[k]);
  }
  if (!used) mesh.attributes.erase(kept);
}

/// Returns the orientations that the options give, and guesses those they do not. Guesses nothing where no
/// start has to be found.
ModelOrientations model_orientations(const Mesh& target, const Mesh& source, std::span<const MergePair> pairs,
                                     const MergeOptions& options) {
  ModelOrientations found{options.target_orientations, options.source_orientations};
  const bool wanted = options.pose == MergePose::find &&
                      std::ranges::any_of(pairs, [](const MergePair& pair) { return pair.matches.empty(); });
  if (wanted && found.target.empty()) found.target = guess_orientations(target);
  if (wanted && found.source.empty()) found.source = guess_orientations(source);
  return found;
}

/// Matches loops of a refined source, from the starts and matches of before.
void match_again(std::span<const PairGeometry> geometry, std::span<const MergePair> given,
                 std::vector<Correspondence>& correspondences) {
  for (std::size_t p = 0; p < geometry.size(); ++p) {
    const std::vector<Match> start{correspondences[p].start};
    correspondences[p].loop_parameter =
        match_by_arc_length(geometry[p], given[p].matches.empty() ? start : given[p].matches).loop_parameter;
  }
}

}  // namespace

std::vector<std::vector<StartCandidate>> find_starts(const Mesh& target, const Mesh& source_mesh,
                                                     std::span<const MergePair> pairs,
                                                     const MergeOptions& options) {
  validate_options(options, source_mesh, target);
  const Mesh source = oriented_as_target(source_mesh, target, options.fix_winding);
  const std::vector<LoopPair> checked = checked_loops(target, source, pairs);
  std::vector<std::vector<StartCandidate>> starts;
  for (Correspondence& found : match_loops(pair_geometry(target, source, checked, options.smooth_boundary),
                                           pairs, connected_components(source), options.pose == MergePose::keep,
                                           model_orientations(target, source_mesh, pairs, options)))
    starts.push_back(std::move(found.starts));
  return starts;
}

MergeResult merge_meshes(const Mesh& target, const Mesh& source_mesh, std::span<const MergePair> pairs,
                         const MergeOptions& options, const Context& context) {
  Stopwatch watch;
  MergeResult result;
  MergeReport& report = result.report;

  // Find the loops and their correspondences.
  context.step("match");
  validate_options(options, source_mesh, target);
  Mesh oriented = oriented_as_target(source_mesh, target, options.fix_winding);
  std::vector<LoopPair> checked = checked_loops(target, oriented, pairs);
  require_held_components(oriented, checked);
  const bool found = options.pose == MergePose::find;
  std::vector<PairGeometry> geometry = pair_geometry(target, oriented, checked, options.smooth_boundary);
  std::vector<Correspondence> correspondences =
      match_loops(geometry, pairs, connected_components(oriented), !found,
                  model_orientations(target, source_mesh, pairs, options));
  RefinedSource source = refine_source(std::move(oriented), std::move(checked), options.seam, context);
  const std::vector<Index> component = connected_components(source.mesh);
  if (source.added > 0) {
    geometry = pair_geometry(target, source.mesh, source.pairs, options.smooth_boundary);
    match_again(geometry, pairs, correspondences);
  }
  for (std::size_t p = 0; p < pairs.size(); ++p)
    report.pairs.push_back(report_pair(geometry[p], correspondences[p], source_mesh.vertex_count()));
  report.source_vertices_added = source.added;
  report.match_seconds = watch.lap();

  // Pose the source near the target, then deform it so that its loops meet the target's.
  context.step("graft");
  const Points posed =
      found ? pose_by_boundary(source.mesh.positions, component, geometry, correspondences, options.size)
            : source.mesh.positions;
  std::vector<VertexConstraint> constraints;
  for (std::size_t p = 0; p < pairs.size(); ++p) {
    BoundaryOptions boundary{options.pose, {}, options.normal_angle_deg};
    if (options.size) boundary.scale = found ? 1 : *options.size;
    const auto held = boundary_constraints(source.pairs[p], geometry[p].source, geometry[p].target,
                                           correspondences[p], boundary);
    report.pairs[p].misfit_rel = misfit_rel(geometry[p].source.points, held);
    constraints.insert(constraints.end(), held.begin(), held.end());
  }
  const Triangles triangles = triangulate(source.mesh, {.skip_out_of_range = true}).triangles;
  FoundGraft graft = graft_within_radius({source.mesh.positions, posed, triangles, component, source.pairs},
                                         constraints, options, context);
  report.shape = graft.shape;
  report.evaluation = graft.graft.evaluation;
  report.assemble_seconds = graft.assemble_seconds;
  report.factorise_seconds = graft.factorise_seconds;
  report.solve_seconds = watch.lap() - report.assemble_seconds - report.factorise_seconds;

  // Join both meshes.
  context.step("seam");
  Mesh grafted = std::move(source.mesh);
  const Points rest = std::exchange(grafted.positions, graft.graft.positions);
  update_normals(grafted, rest);
  SeamResult seam = make_seam(target, grafted, source.pairs, options.seam, context);
  result.grafted = graft.graft.positions.topRows(source_mesh.vertex_count());
  result.mesh = std::move(seam.mesh);
  drop_used_cut_normals(result.mesh);
  result.target = std::move(seam.target);
  const auto kept = std::count_if(result.target.new_index.begin(), result.target.new_index.end(),
                                  [](Index v) { return v >= 0; });
  report.target_vertices_added = result.mesh.vertex_count() - grafted.vertex_count() - static_cast<Index>(kept);
  result.source = std::move(seam.source);
  result.source.new_index.resize(source_mesh.vertex_count());  // original ones only
  result.new_faces = std::move(seam.new_faces);
  result.band = std::move(seam.band);
  report.seam = seam.report;
  report.seam_seconds = watch.lap();

  // Tell what a user should know.
  report.notes = std::move(seam.notes);
  const std::vector<Note> notes = merge_notes(report, options);
  report.notes.insert(report.notes.end(), notes.begin(), notes.end());
  report.total_seconds = watch.seconds();
  return result;
}

}  // namespace meshgraft
