#include <algorithm>
#include <iterator>
#include <optional>
#include <utility>

#include <meshgraft/core/error.h>
#include <meshgraft/mesh/normals.h>
#include <meshgraft/select/selection.h>

#include "core/stopwatch.h"
#include "deform/facts.h"
#include "deform/sculpt.h"
#include "run_steps.h"
#include "script/facts.h"
#include "selection_resolver.h"
#include "symmetry.h"

namespace meshgraft {

namespace {

Points sculpted(const SculptStep& step, const SculptedSurface& surface, const Context& context) {
  switch (step.action) {
    case SculptAction::smooth: return smooth_region(surface, step.strength, context);
    case SculptAction::inflate: return inflate_region(surface, step.height, context);
    case SculptAction::flatten: return flatten_region(surface, step.strength, context);
  }
  return surface.points;
}

// Returns the vertices at one position that the step moves as one. Vertices at a cut stay apart.
Weld weld_of(const MeshState& state) {
  const Finding* torn = state.diagnostics.find(FindingKind::duplicate_vertex);
  return torn == nullptr || state.is_cut ? Weld{} : weld_at(state.mesh, torn->indices);
}

}  // namespace

StepReport run_sculpt(const EditFile& edit, const EditStep& edit_step, const Location& location,
                      std::map<std::string, MeshState>& states, const Context& context) {
  const auto& step = std::get<SculptStep>(edit_step.action);
  Stopwatch watch;
  MeshState& state = state_for_outcome(edit_step, states);
  StepReport report;
  report.mesh = step.mesh;
  report.result = outcome_of(edit_step);
  const Weld weld = weld_of(state);
  std::optional<Mesh> joined;
  if (!weld.empty()) joined = welded(state.mesh, weld);
  Mesh& mesh = joined ? *joined : state.mesh;

  context.step("select");
  const SelectionMesh selections(mesh, weld);
  SelectionResolver resolver(edit, selections, state.produced);
  MirroredRegion regions{.own = resolver.vertices(step.region, location / "region")};
  if (regions.own.empty()) throw Error(facts::script::SelectionEmpty{}, location / "region");
  if (step.symmetry) {
    regions = mirrored_region(regions.own, *step.symmetry, selections, location / "symmetry");
    report.symmetry =
        SymmetryReport{.reflection = regions.reflection, .without_partner = regions.without_partner};
    if (regions.note) report.notes.push_back(*regions.note);
  }
  std::vector<Index> region;
  std::set_union(regions.own.begin(), regions.own.end(), regions.image.begin(), regions.image.end(),
                 std::back_inserter(region));
  constexpr int read_rings = 2;  // around the region
  const std::vector<Index> read = grow_rings(region, read_rings, selections.rings);
  require_sound(state.diagnostics, mesh, {.vertices = read, .name = state.label});
  report.seconds.select = watch.lap();
  const Triangles triangles = triangulate(mesh, {.skip_out_of_range = true}).triangles;
  Points moved;
  try {
    moved = sculpted(step, {mesh.positions, triangles, regions.own}, context);
    if (!regions.image.empty()) {  // from the same positions, so that both sides agree
      const Points other = sculpted(step, {mesh.positions, triangles, regions.image}, context);
      for (const Index v : regions.image) moved.row(v) = other.row(v);
    }
    for (const Index v : region)
      if (!moved.row(v).allFinite()) throw Error(facts::deform::SolutionNotFinite{.vertex = v});
  } catch (const Error& error) {
    if (error.code() == ErrorCode::cancelled) throw;
    throw error.within(location);
  }
  const Points before = std::exchange(mesh.positions, std::move(moved));
  update_normals(mesh, before);
  report.sculpt = SculptOutcome{step.action, static_cast<Index>(region.size()),
                                largest_displacement(before, mesh.positions)};
  if (joined) unweld(*joined, weld, state.mesh);
  report.seconds.solve = watch.lap();
  for (const Index v : region) state.was_free[v] = 1;
  for (Index v = 0; v < state.mesh.vertex_count(); ++v) state.was_free[v] = state.was_free[weld.of(v)];
  report.counts.vertices = state.mesh.vertex_count();
  report.counts.faces = state.mesh.face_count();
  report.seconds.total = watch.seconds();
  return report;
}

}  // namespace meshgraft
