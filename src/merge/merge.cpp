#include <meshgraft/merge/merge.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include <meshgraft/core/error.h>
#include <meshgraft/mesh/cut.h>
#include <meshgraft/mesh/topology.h>

#include "core/stopwatch.h"
#include "graft_meshes.h"
#include "match_loops.h"
#include "match_meshes.h"
#include "merge/facts.h"
#include "merge_notes.h"
#include "report_pair.h"
#include "retry.h"
#include "validate_options.h"

namespace meshgraft {

namespace {

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

/// Throws Error(input) where several loops of one piece of the source lie so differently from those that they
/// meet that the piece turns inside out.
void require_no_inverting_pairs(const MatchedMeshes& matched, const GraftedSource& grafted) {
  // Measured: of random grafts with several pairs, those that stay inverted have loops 1.4 radii apart or more
  // (docs/merging.md, "Random grafts").
  constexpr double far_apart = 1;
  const Index inverted = grafted.found.shape.inverted;
  if (inverted == 0) return;
  for (const std::vector<std::size_t>& members : pairs_by_component(matched.geometry, matched.component)) {
    const std::size_t worst =
        *std::ranges::max_element(members, {}, [&](std::size_t p) { return grafted.misfits_rel[p]; });
    const double radii = grafted.misfits_rel[worst];
    if (members.size() < 2 || radii <= far_apart) continue;
    throw Error(facts::merge::PairsInvertSource{.pair = worst, .radii = radii, .vertices = inverted},
                matched.geometry[worst].location);
  }
}

}  // namespace

MergeResult merge_meshes(const Mesh& target, const Mesh& source_mesh, std::span<const MergePair> pairs,
                         const MergeOptions& options, const Context& context) {
  Stopwatch watch;
  MergeResult result;
  MergeReport& report = result.report;

  // Find the loops and their correspondences.
  context.step("match");
  validate_options(options, source_mesh, target);
  const MatchedMeshes matched = match_meshes(target, source_mesh, pairs, options, context);
  report.match_seconds = watch.lap();

  // Deform the source so that its loops meet the target's.
  context.step("graft");
  MadeGraft made{.correspondences = matched.correspondences};
  made.grafted = graft_source(matched, made.correspondences, options, 0, context);
  report.assemble_seconds = made.grafted.found.assemble_seconds;
  report.factorise_seconds = made.grafted.found.factorise_seconds;
  report.solve_seconds = watch.lap() - report.assemble_seconds - report.factorise_seconds;

  // Join both meshes.
  context.step("seam");
  made.seam = join_source(matched, made.grafted, options, context);
  report.seam_seconds = watch.lap();

  // Graft again, with other settings, as long as there are faults at the seam.
  const bool may_retry =
      options.retry && options.shape == MergeShape::similar && options.pose == MergePose::find;
  if (may_retry && made.faults() > 0) report.retry = retry_graft(matched, pairs, options, context, made);
  if (may_retry) require_no_inverting_pairs(matched, made.grafted);
  report.retry_seconds = watch.lap();

  const FoundGraft& found = made.grafted.found;
  for (std::size_t p = 0; p < pairs.size(); ++p) {
    report.pairs.push_back(report_pair(matched.geometry[p], made.correspondences[p], matched.given_vertices));
    report.pairs[p].misfit_rel = made.grafted.misfits_rel[p];
  }
  report.source_vertices_added = matched.source.added;
  report.shape = found.shape;
  report.evaluation = found.graft.evaluation;
  result.grafted = found.graft.positions.topRows(source_mesh.vertex_count());

  SeamResult& seam = made.seam;
  result.mesh = std::move(seam.mesh);
  drop_used_cut_normals(result.mesh);
  result.target = std::move(seam.target);
  const auto kept = std::count_if(result.target.new_index.begin(), result.target.new_index.end(),
                                  [](Index v) { return v >= 0; });
  report.target_vertices_added =
      result.mesh.vertex_count() - matched.source.mesh.vertex_count() - static_cast<Index>(kept);
  result.source = std::move(seam.source);
  result.source.new_index.resize(source_mesh.vertex_count());  // original ones only
  result.new_faces = std::move(seam.new_faces);
  result.band = std::move(seam.band);
  report.seam = seam.report;

  // Tell what a user should know.
  report.notes = std::move(seam.notes);
  const std::vector<Note> notes = merge_notes(report, options);
  report.notes.insert(report.notes.end(), notes.begin(), notes.end());
  report.total_seconds = watch.seconds();
  return result;
}

}  // namespace meshgraft
