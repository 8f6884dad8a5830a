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

/// Throws Error(input) where several loops of a source in one piece lie so differently from those that they
/// meet that it turned inside out in every graft that was tried. `misfits_rel` has those of the best
/// similarity.
void require_no_inverting_pairs(const MatchedMeshes& matched, const MadeGraft& made,
                                std::span<const double> misfits_rel) {
  // Measured: of random grafts with several pairs, those that stay inverted have loops 1.8 radii apart or more
  // (docs/merging.md, "Random grafts").
  constexpr double far_apart = 1;
  const bool is_one_piece = std::ranges::max(matched.component) == 0;
  if (made.fewest_inverted == 0 || misfits_rel.size() < 2 || !is_one_piece) return;
  const auto worst = std::ranges::max_element(misfits_rel);
  if (*worst <= far_apart) return;
  const auto pair = static_cast<std::size_t>(worst - misfits_rel.begin());
  throw Error(facts::merge::PairsInvertSource{.pair = pair, .radii = *worst, .vertices = made.fewest_inverted},
              matched.geometry[pair].location);
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
  made.fewest_inverted = made.grafted.found.shape.inverted;
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
  if (may_retry && made.faults() > 0) {
    const std::vector<double> misfits_rel = made.grafted.misfits_rel;
    report.retry = retry_graft(matched, pairs, options, context, made);
    require_no_inverting_pairs(matched, made, misfits_rel);
  }
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
