#include <meshgraft/merge/merge.h>

#include <algorithm>
#include <array>
#include <numeric>
#include <span>
#include <utility>

#include <meshgraft/core/error.h>
#include <meshgraft/deform/quality.h>

#include "drop_size.h"
#include "merge/facts.h"
#include "merge_conflict.h"

namespace meshgraft {

namespace {

std::int64_t count_pairs(const Mesh& mesh, std::span<const Index> vertices, const Context& context) {
  return count_self_intersections(mesh.positions, triangulate(mesh).triangles, vertices, context);
}

/// One attempt at one size.
struct Trial {
  OpenedHole hole;
  DropResult drop;

  Index inverted() const { return drop.merge.report.shape.inverted; }
};

Trial graft_in_hole(OpenedHole hole, const Mesh& source, const MergeOptions& asked, const Context& context) {
  Trial trial{std::move(hole), {}};
  DropResult& drop = trial.drop;
  drop.options = asked;
  drop.options.size = trial.hole.size;
  const std::array pairs{trial.hole.pair};
  drop.merge = merge_meshes(trial.hole.target, source, pairs, drop.options, context);
  if (asked.normal_angle_deg == 0)
    for (const double angle_deg : {-45.0, -90.0}) {
      if (trial.inverted() == 0) break;
      MergeOptions options = drop.options;
      options.normal_angle_deg = angle_deg;
      MergeResult other = merge_meshes(trial.hole.target, source, pairs, options, context);
      if (other.report.shape.inverted >= trial.inverted()) continue;
      drop.merge = std::move(other);
      drop.options = options;
    }
  drop.notes = trial.hole.notes;
  if (drop.options.normal_angle_deg != asked.normal_angle_deg)
    drop.notes.push_back(facts::merge::BentLess{.normal_angle_deg = drop.options.normal_angle_deg});
  drop.intersections = count_intersections(source, drop.merge, context);
  return trial;
}

}  // namespace

MergeIntersections count_intersections(const Mesh& source, const MergeResult& merged, const Context& context) {
  context.step("measure");
  std::vector<Index> moved;
  for (const Index v : merged.source.new_index)
    if (v >= 0) moved.push_back(v);
  for (const Index face : merged.new_faces)
    moved.insert(moved.end(), merged.mesh.faces[face].begin(), merged.mesh.faces[face].end());
  std::sort(moved.begin(), moved.end());
  moved.erase(std::unique(moved.begin(), moved.end()), moved.end());
  MergeIntersections found;
  found.result = count_pairs(merged.mesh, moved, context);
  if (found.result == 0) return found;
  std::vector<Index> all(source.vertex_count());
  std::iota(all.begin(), all.end(), Index{0});
  found.source = count_pairs(source, all, context);
  return found;
}

DropResult drop_source(const Mesh& target, const Mesh& source, const Drop& drop, const MergeOptions& options,
                       const Context& context) {
  constexpr int most_tries = 3;
  if (find_conflict({.pose = options.pose, .dropped = true}))
    throw Error(facts::merge::DroppedPoseKept{}, "pose");
  Drop trying = drop;
  const auto trial_of_size = [&] {
    return graft_in_hole(open_hole(target, source, trying, context), source, options, context);
  };
  Trial best = trial_of_size();
  trying.size = best.hole.size;
  for (int k = 0; k < most_tries && !drop.size; ++k) {
    if (best.inverted() == 0 && (!best.hole.clear || !best.drop.intersections.any_new())) break;
    trying.size = next_size_ratio * *trying.size;
    try {
      Trial other = trial_of_size();
      const bool better =
          other.inverted() < best.inverted() || (other.inverted() == 0 && !other.drop.intersections.any_new());
      if (!better) continue;
      best = std::move(other);
    } catch (const Error& error) {
      if (error.code() == ErrorCode::cancelled) throw;
      continue;  // the source does not fit in this size
    }
    best.drop.notes.push_back(facts::merge::SourceScaledToGraft{.size = *trying.size});
  }
  if (best.inverted() > 0 && options.shape == MergeShape::similar)
    throw Error(facts::merge::DroppedSourceInverted{.vertices = best.inverted(), .size = best.hole.size},
                "surface_point");
  // Composes the target's map from the closed target, before the hole was cut.
  IndexMap& map = best.drop.merge.target;
  IndexMap from_closed = best.hole.vertex;
  for (Index& v : from_closed.new_index)
    if (v >= 0) v = map.new_index[v];
  map = std::move(from_closed);
  return std::move(best.drop);
}

}  // namespace meshgraft
