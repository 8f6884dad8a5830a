#include <meshgraft/mesh/repair.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <mutex>

#include <meshgraft/core/error.h>

#include "core/facts.h"
#include "mesh/facts.h"
#include "mesh/intersecting_triangles.h"
#include "repair_surface.h"

namespace meshgraft {

namespace {

void check(const RepairOptions& options) {
  if (options.weld_distance && !(*options.weld_distance >= 0 && std::isfinite(*options.weld_distance)))
    throw Error(facts::core::NegativeOrNotFinite{.value = *options.weld_distance}, "weld_distance");
  if (!(options.debris_rel >= 0 && options.debris_rel <= 1))
    throw Error(facts::core::OutOfRange{.value = options.debris_rel, .low = 0, .high = 1}, "debris_rel");
  if (options.hole_edges && *options.hole_edges < 0)
    throw Error(facts::core::Negative{.value = *options.hole_edges}, "hole_edges");
}

// Throws for invalid elements, because no other step works with them.
void require_valid(const Mesh& mesh) {
  triangulate(mesh);  // throws for an index out of range
  for (const Index v : mesh.faces.corners())
    if (!mesh.positions.row(v).allFinite()) throw Error(facts::mesh::VertexNotFinite{.vertex = v});
}

// Runs all steps except those that need a clean surface. Returns whether anything changed.
bool mend(RepairSurface& surface, const RepairOptions& options) {
  const bool join = options.weld;
  bool changed = false;
  const auto run = [&](bool wanted, const auto& step) {
    surface.context().throw_if_stopped();
    if (wanted && step()) changed = true;
  };
  run(options.remove_invalid, [&] { return remove_invalid(surface); });
  run(options.clean_faces, [&] { return clean_corners(surface); });
  run(options.clean_faces, [&] { return remove_duplicate_faces(surface); });
  run(options.remove_duplicate_shells, [&] { return remove_duplicate_shells(surface); });
  run(options.clean_faces, [&] { return remove_zero_area(surface, join); });
  run(options.clean_faces, [&] { return clean_corners(surface); });
  run(join, [&] { return split_t_junctions(surface, options.weld_distance); });
  run(join, [&] { return stitch(surface, options.weld_distance); });
  run(options.clean_faces, [&] { return clean_corners(surface); });
  run(options.split_non_manifold, [&] { return split_non_manifold(surface); });
  return changed;
}

// Returns whether two triangles intersect in more than vertices at one position and edges between these.
bool intersect_beyond_positions(const Points& positions, const Triangles& triangles,
                                const std::array<Index, 2>& pair) {
  Triangles two(2, 3);
  two << triangles.row(pair[0]), triangles.row(pair[1]);
  for (Eigen::Index i = 0; i < 3; ++i)
    for (Eigen::Index j = 0; j < 3; ++j)
      if (positions.row(two(1, i)) == positions.row(two(0, j))) two(1, i) = two(0, j);
  return intersect(positions, two, {0, 1});
}

// Notes how many triangles that fill holes intersect the surface or each other.
void note_intersecting_fills(RepairResult& result, const Context& context) {
  if (result.find(RepairChangeKind::filled_hole) == nullptr) return;
  const Triangulation surface = triangulate(result.mesh);
  const auto fills = [&](Index triangle) { return result.face_origin[surface.face[triangle]] < 0; };
  Flags is_fill(surface.triangles.rows(), 0), is_crossed = is_fill;
  for (Index t = 0; t < static_cast<Index>(is_fill.size()); ++t) is_fill[t] = fills(t);
  std::mutex marking;
  find_intersections(
      result.mesh.positions, surface.triangles, is_fill,
      [&](const std::array<Index, 2>& pair) {
        if (!intersect_beyond_positions(result.mesh.positions, surface.triangles, pair)) return;
        const std::scoped_lock lock(marking);
        for (const Index t : pair) is_crossed[t] = is_fill[t];
      },
      context);
  const auto count = static_cast<Index>(std::count(is_crossed.begin(), is_crossed.end(), 1));
  if (count == 0) return;
  const auto first = std::find(is_crossed.begin(), is_crossed.end(), 1) - is_crossed.begin();
  result.notes.push_back(facts::mesh::HoleFillIntersects{.count = count, .first = surface.face[first]});
}

}  // namespace

const RepairChange* RepairResult::find(RepairChangeKind kind) const {
  const auto found = std::find_if(changes.begin(), changes.end(),
                                  [&](const RepairChange& change) { return change.kind == kind; });
  return found == changes.end() ? nullptr : &*found;
}

// Repeats until no step changes anything, because a step may leave work for an earlier one. A second repair
// then has nothing left to do.
RepairResult repair(const Mesh& mesh, const RepairOptions& options, const Context& context) {
  check(options);
  if (!options.remove_invalid) require_valid(mesh);
  constexpr int most_rounds = 30;
  RepairSurface surface(mesh, context);
  for (int round = 0;; ++round) {
    if (round == most_rounds) {
      surface.note(facts::mesh::RepairUnfinished{.rounds = most_rounds});
      break;
    }
    context.step("repair", static_cast<double>(round) / most_rounds);
    if (mend(surface, options)) continue;
    context.throw_if_stopped();
    if (options.hole_edges != 0 && fill_cracks(surface, options)) continue;
    context.throw_if_stopped();
    if (options.remove_debris && remove_debris(surface, options.debris_rel)) continue;
    context.throw_if_stopped();
    if (options.unify_winding && unify_winding(surface)) continue;
    context.throw_if_stopped();
    if (options.hole_edges != 0 && fill_holes(surface, options)) continue;
    break;
  }
  context.step("repair", 1);
  RepairResult result = surface.finish(options.remove_isolated);
  note_intersecting_fills(result, context);
  return result;
}

}  // namespace meshgraft
