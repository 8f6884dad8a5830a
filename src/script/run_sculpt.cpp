#include <algorithm>
#include <iterator>
#include <optional>
#include <utility>

#include <meshgraft/core/error.h>
#include <meshgraft/deform/quality.h>
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
    case SculptAction::inflate: return inflate_region(surface, step.height, step.reach, context);
    case SculptAction::flatten: return flatten_region(surface, step.strength, step.reach, context);
  }
  return surface.points;
}

/// Holds a region and its mirror image, and the vertices that move with each.
struct BothSides {
  SculptedSurface own, image;
  std::vector<Index> with_own, with_image;
};

// Shapes both sides from the same positions, so that they agree. A vertex within both reaches makes both
// movements in part: all of one and nothing of the other where only one weight is 1, half of each where both
// are, and never more than the larger one in all.
Points sculpted(const SculptStep& step, const BothSides& sides, const Context& context) {
  Points moved = sculpted(step, sides.own, context);
  if (sides.with_image.empty()) return moved;
  const Points other = sculpted(step, sides.image, context);
  std::vector<Index> shared;
  std::set_intersection(sides.with_own.begin(), sides.with_own.end(), sides.with_image.begin(),
                        sides.with_image.end(), std::back_inserter(shared));
  const Points first = moved;
  for (const Index v : sides.with_image) moved.row(v) = other.row(v);
  if (shared.empty()) return moved;
  const std::vector<double> one = reach_weights(sides.own, step.reach.value()),
                            two = reach_weights(sides.image, step.reach.value());
  for (const Index v : shared) {
    const double a = one[v], b = two[v], sum = a + b - 2 * a * b;
    const Eigen::RowVector3d rest = sides.own.points.row(v);
    const Eigen::RowVector3d by = first.row(v) - rest, by_other = other.row(v) - rest;
    const double share = sum > 0 ? (1 - b) * (a + b - a * b) / sum : 0.5,
                 other_share = sum > 0 ? (1 - a) * (a + b - a * b) / sum : 0.5;
    moved.row(v) = rest + share * by + other_share * by_other;
  }
  return moved;
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
  const Triangles triangles = triangulate(mesh, {.skip_out_of_range = true}).triangles;
  BothSides sides{{mesh.positions, triangles, regions.own}, {mesh.positions, triangles, regions.image}, {}, {}};
  sides.with_own = vertices_within(sides.own, step.reach);
  sides.with_image = vertices_within(sides.image, step.reach);
  std::vector<Index> region;
  std::set_union(sides.with_own.begin(), sides.with_own.end(), sides.with_image.begin(), sides.with_image.end(),
                 std::back_inserter(region));
  const std::vector<Index> read = with_rings_read(sides.own, region);
  require_sound(state.diagnostics, mesh, {.vertices = read, .name = state.label});
  report.seconds.select = watch.lap();
  Points moved;
  try {
    moved = sculpted(step, sides, context);
    for (const Index v : region)
      if (!moved.row(v).allFinite()) throw Error(facts::deform::SolutionNotFinite{.vertex = v});
  } catch (const Error& error) {
    if (error.code() == ErrorCode::cancelled) throw;
    throw error.within(location);
  }
  const Points before = std::exchange(mesh.positions, std::move(moved));
  update_normals(mesh, before);
  report.seconds.solve = watch.lap();
  report.sculpt =
      SculptOutcome{step.action, static_cast<Index>(regions.own.size() + regions.image.size()),
                    largest_displacement(before, mesh.positions),
                    count_new_self_intersections({before, mesh.positions, triangles, region}, context)};
  report.seconds.measure = watch.lap();
  if (joined) unweld(*joined, weld, state.mesh);
  for (const Index v : region) state.was_free[v] = 1;
  for (Index v = 0; v < state.mesh.vertex_count(); ++v) state.was_free[v] = state.was_free[weld.of(v)];
  report.counts.vertices = state.mesh.vertex_count();
  report.counts.faces = state.mesh.face_count();
  report.seconds.total = watch.seconds();
  return report;
}

}  // namespace meshgraft
