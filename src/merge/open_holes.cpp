#include "open_holes.h"

#include <algorithm>
#include <memory>
#include <numeric>
#include <optional>
#include <utility>
#include <variant>

#include <meshgraft/core/error.h>
#include <meshgraft/mesh/topology.h>

#include "drop_size.h"
#include "flat_loop.h"
#include "merge/facts.h"
#include "placement.h"
#include "prepared_target.h"

namespace meshgraft {

namespace {

using HolesOrReason = std::variant<OpenedHoles, Note>;

/// A source on several feet, and the target.
struct Standing {
  const Mesh& target;
  const PreparedTarget& prepared;
  const std::vector<FlatLoop>& feet;
  const FlatLoop& hull;
};

/// Renames the pairs' target vertices after a further hole was opened. Returns false where the hole met
/// another one.
bool rename_targets(std::vector<MergePair>& pairs, const IndexMap& vertex, const Mesh& target) {
  const std::vector<std::vector<Index>> loops = boundary_loops(target);
  for (MergePair& pair : pairs) {
    for (Match& match : pair.matches) {
      match.target = vertex.new_index[match.target];
      if (match.target < 0) return false;
    }
    const Index known = vertex.new_index[pair.loops.target.front()];
    const auto loop = std::find_if(loops.begin(), loops.end(), [&](const std::vector<Index>& candidate) {
      return std::find(candidate.begin(), candidate.end(), known) != candidate.end();
    });
    if (loop == loops.end()) return false;
    pair.loops.target = *loop;
  }
  return true;
}

/// Opens the holes of all feet in one size. Returns the reason where there is no room for one of them.
HolesOrReason open_for_feet(const Standing& standing, const Drop& drop, double size, const Context& context) {
  constexpr double most_above =
      0.5;  // chosen, × the hull's width: a foot farther from the surface hangs in the air
  const SurfacePoint point = find_surface_point(standing.prepared, drop);
  const Placement placement = place_outline(standing.prepared, point, standing.hull, size, drop.spin_deg);
  const Eigen::Affine3d map = placement_map(standing.hull, placement, size, point.point);
  OpenedHoles holes{.target = standing.target, .size = size};
  holes.vertex.new_index.resize(standing.target.vertex_count());
  std::iota(holes.vertex.new_index.begin(), holes.vertex.new_index.end(), Index{0});
  for (const FlatLoop& foot : standing.feet) {
    const FlatLoop posed = moved(foot, map);
    const auto current = std::make_shared<const Mesh>(std::move(holes.target));
    const Triangles triangles = triangulate(*current, {.skip_out_of_range = true}).triangles;
    const SurfacePoint below = find_nearest_point(current->positions, triangles, posed.centre);
    if ((below.point - posed.centre).norm() > most_above * size * standing.hull.outline.width())
      return Note(facts::merge::FootBesideSurface{.size = size});
    const Drop here{.surface_point = Eigen::Vector3d(below.point.transpose()), .size = 1};
    auto opened = open_hole_for_loop(*current, posed, here, context);
    if (auto* reason = std::get_if<Note>(&opened)) return std::move(*reason);
    OpenedHole& hole = std::get<OpenedHole>(opened);
    if (!rename_targets(holes.pairs, hole.vertex, hole.target))
      return Note(facts::merge::FeetTooClose{.size = size});
    compose(holes.vertex, hole.vertex);
    holes.pairs.push_back(std::move(hole.pair));
    holes.target = std::move(hole.target);
  }
  return holes;
}

OpenedHoles open_several(const Mesh& target, const Mesh& source, const std::vector<std::vector<Index>>& loops,
                         const Drop& drop, const Context& context) {
  constexpr int most_sizes = 10;
  validate(drop, target);
  require_inner_point(target, drop);
  std::vector<FlatLoop> feet;
  for (const std::vector<Index>& loop : loops) feet.push_back(flatten_loop(target, source, loop));
  const FlatLoop hull = hull_of_loops(source.positions, feet);
  const PreparedTarget prepared(std::shared_ptr<const Mesh>(&target, [](const Mesh*) {}), context);
  const Standing standing{target, prepared, feet, hull};
  std::optional<Note> why;
  double size = drop.size.value_or(1);
  for (int k = 0; k < (drop.size ? 1 : most_sizes); ++k, size *= next_size_ratio) {
    HolesOrReason opened = open_for_feet(standing, drop, size, context);
    if (auto* holes = std::get_if<OpenedHoles>(&opened)) {
      if (why) holes->notes = {facts::merge::SourceScaled{.size = size}, *why};
      return std::move(*holes);
    }
    why = std::get<Note>(opened);
  }
  throw Error(facts::merge::NoHoleAtAnySize{}, "surface_point").with(*why);
}

}  // namespace

void compose(IndexMap& map, const IndexMap& next) {
  for (Index& v : map.new_index)
    if (v >= 0) v = next.new_index[v];
}

OpenedHoles open_holes(const Mesh& target, const Mesh& source, const std::vector<std::vector<Index>>& loops,
                       const Drop& drop, const Context& context) {
  if (loops.size() > 1) {
    context.step("open");
    return open_several(target, source, loops, drop, context);
  }
  Drop one = drop;
  one.source_loop = loops.front();
  OpenedHole hole = open_hole(target, source, one, context);
  return {std::move(hole.target), std::move(hole.vertex), {std::move(hole.pair)}, hole.size, hole.clear,
          std::move(hole.notes)};
}

}  // namespace meshgraft
