#include <meshgraft/merge/merge.h>

#include <algorithm>
#include <numeric>
#include <span>
#include <utility>
#include <vector>

#include <meshgraft/core/error.h>
#include <meshgraft/deform/quality.h>
#include <meshgraft/mesh/topology.h>

#include "drop_size.h"
#include "merge/facts.h"
#include "merge_conflict.h"
#include "merge_notes.h"
#include "open_base.h"
#include "open_holes.h"

namespace meshgraft {

namespace {

std::int64_t count_pairs(const Mesh& mesh, std::span<const Index> vertices, const Context& context) {
  return count_self_intersections(mesh.positions, triangulate(mesh).triangles, vertices, context);
}

constexpr int most_size_tries = 3;

/// Returns whether a graft turned inside out, or shrank, so that one whose boundary bends less may be better.
/// With `MergeShape::similar` no source shrinks.
bool bends_too_much(const MergeResult& merge, const MergeOptions& options) {
  constexpr double small = 0.7;  // chosen: √0.5, where merge_notes.cpp calls 0.5 shrunk
  return merge.report.shape.inverted > 0 || relative_scale(merge.report, options) < small;
}

/// Returns whether a graft turned inside out less than another, or as much and is larger.
bool is_better(const MergeResult& merge, const MergeResult& other) {
  const auto inverted = [](const MergeResult& graft) { return graft.report.shape.inverted; };
  constexpr double larger = 1.1;  // chosen: smaller gains are not worth bending less
  return inverted(merge) < inverted(other) ||
         (inverted(merge) == inverted(other) &&
          merge.report.shape.similarity.scale > larger * other.report.shape.similarity.scale);
}

/// One attempt at one size.
struct Trial {
  OpenedHoles hole;
  DropResult drop;

  Index inverted() const { return drop.merge.report.shape.inverted; }
  /// Returns the faults at the seams, but for those of a source that is larger than the room.
  Index faults_at_seam() const {
    const SeamFaults& faults = drop.merge.report.seam.faults;
    return inverted() + faults.folded_edges + faults.crossings;
  }
  bool is_good() const { return faults_at_seam() == 0 && (!hole.clear || !drop.intersections.any_new()); }
};

Trial graft_in_hole(OpenedHoles hole, const Mesh& source, const MergeOptions& asked, const Context& context) {
  Trial trial{std::move(hole), {}};
  DropResult& drop = trial.drop;
  drop.options = asked;
  drop.options.size = trial.hole.size;
  drop.options.retry = false;  // other sizes and angles are tried here
  const std::vector<MergePair>& pairs = trial.hole.pairs;
  drop.merge = merge_meshes(trial.hole.target, source, pairs, drop.options, context);
  if (asked.normal_angle_deg == 0)
    for (const double angle_deg : {-45.0, -90.0}) {
      if (!bends_too_much(drop.merge, drop.options)) break;
      MergeOptions options = drop.options;
      options.normal_angle_deg = angle_deg;
      MergeResult other = merge_meshes(trial.hole.target, source, pairs, options, context);
      if (!is_better(other, drop.merge)) continue;
      drop.merge = std::move(other);
      drop.options = options;
    }
  drop.notes = trial.hole.notes;
  if (drop.options.normal_angle_deg != asked.normal_angle_deg)
    drop.notes.push_back(facts::merge::BentLess{.normal_angle_deg = drop.options.normal_angle_deg});
  drop.intersections = count_intersections(source, drop.merge, context);
  return trial;
}

/// Grafts again with other settings where the seam has faults. The first of these grafts is the same as before.
void retry_in_hole(Trial& trial, const Mesh& source, const Context& context) {
  DropResult& drop = trial.drop;
  MergeOptions options = drop.options;
  options.retry = true;
  try {
    drop.merge = merge_meshes(trial.hole.target, source, trial.hole.pairs, options, context);
  } catch (const Error& error) {
    if (error.id() != facts::merge::PairsInvertSource::id) throw;
    return;  // the graft without retries stays
  }
  if (const double angle_deg = drop.merge.report.retry.normal_angle_deg; angle_deg != 0)
    drop.options.normal_angle_deg = angle_deg;
  drop.intersections = count_intersections(source, drop.merge, context);
}

/// Drops a source that stands on the given loops. Where the result has faults, and `most_tries` is not 0, it
/// tries other settings, then up to `most_tries` smaller sizes where none is given.
DropResult drop_open_source(const Mesh& target, const Mesh& source,
                            const std::vector<std::vector<Index>>& loops, const Drop& drop,
                            const MergeOptions& options, int most_tries, const Context& context) {
  Drop trying = drop;
  const auto trial_of_size = [&] {
    return graft_in_hole(open_holes(target, source, loops, trying, context), source, options, context);
  };
  Trial best = trial_of_size();
  trying.size = best.hole.size;
  if (options.retry && most_tries > 0 && best.faults_at_seam() > 0) retry_in_hole(best, source, context);
  for (int k = 0; k < most_tries && !drop.size; ++k) {
    if (best.is_good()) break;
    trying.size = next_size_ratio * *trying.size;
    try {
      Trial other = trial_of_size();
      const bool clean = other.faults_at_seam() == 0 && !other.drop.intersections.any_new();
      if (!clean && other.faults_at_seam() >= best.faults_at_seam()) continue;
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
  best.drop.options.retry = options.retry;
  // Composes the target's map from the closed target, before the hole was cut.
  IndexMap& map = best.drop.merge.target;
  compose(best.hole.vertex, map);
  map = std::move(best.hole.vertex);
  return std::move(best.drop);
}

/// Names the vertices of a result of the opened source as the closed source does.
void refer_to_closed(DropResult& dropped, const OpenedSource& opened, const Mesh& closed) {
  MergeResult& merge = dropped.merge;
  const Similarity& rest = merge.report.shape.similarity;
  Points grafted =
      (rest.scale * closed.positions * rest.rotation.transpose()).rowwise() + rest.translation.transpose();
  IndexMap map = opened.vertex;
  for (Index v = 0; v < closed.vertex_count(); ++v) {
    Index& now = map.new_index[v];
    if (now < 0) continue;
    grafted.row(v) = merge.grafted.row(now);
    now = merge.source.new_index[now];
  }
  merge.source = std::move(map);
  merge.grafted = std::move(grafted);
  for (PairReport& pair : merge.report.pairs) {
    pair.start.source = opened.nearest[pair.start.source];
    for (Index& v : pair.met) v = opened.nearest[v];
  }
}

/// Returns the features of a closed source on the opened one, without what was cut away.
std::vector<MergeFeature> features_on(const OpenedSource& opened, const std::vector<MergeFeature>& features) {
  std::vector<MergeFeature> kept;
  for (const MergeFeature& feature : features) {
    MergeFeature& left = kept.emplace_back(std::vector<Index>{}, feature.similarity);
    for (const Index v : feature.vertices)
      if (v >= 0 && static_cast<std::size_t>(v) < opened.vertex.new_index.size() &&
          opened.vertex.new_index[v] >= 0)
        left.vertices.push_back(opened.vertex.new_index[v]);
    if (left.vertices.empty()) kept.pop_back();
  }
  return kept;
}

Note note_of(const BaseReport& base) {
  return facts::merge::BaseCut{.loops = base.loops,
                               .height = base.height,
                               .x = base.point.x(),
                               .y = base.point.y(),
                               .z = base.point.z(),
                               .normal_x = base.normal.x(),
                               .normal_y = base.normal.y(),
                               .normal_z = base.normal.z()};
}

DropResult drop_opened(const Mesh& target, const Mesh& source, const OpenedSource& opened, const Drop& drop,
                       const MergeOptions& options, int most_tries, const Context& context) {
  MergeOptions of_opened = options;
  of_opened.features = features_on(opened, options.features);
  DropResult dropped =
      drop_open_source(target, opened.mesh, opened.loops, drop, of_opened, most_tries, context);
  refer_to_closed(dropped, opened, source);
  dropped.options.features = options.features;
  dropped.base = opened.report;
  dropped.notes.insert(dropped.notes.begin(), note_of(opened.report));
  constexpr double much = 0.3;  // chosen, × all vertices
  if (const double share = static_cast<double>(opened.report.cut_away) / source.vertex_count(); share > much)
    dropped.notes.push_back(facts::merge::BaseTakesMuch{.percent = 100 * share});
  return dropped;
}

/// Counts the faults at the seams, or the new intersections where these are more. A source with intersections
/// of its own may lose some and get others at the seam.
std::int64_t count_faults(const DropResult& dropped) {
  const auto& [result, source] = dropped.intersections;
  const MergeReport& report = dropped.merge.report;
  const Index at_seam = report.shape.inverted + report.seam.faults.total();
  return std::max<std::int64_t>(at_seam, result - source);
}

/// Drops of a closed source by several planes, of which the best one is kept.
struct BestDrop {
  std::optional<DropResult> result;
  std::size_t plane = 0;
  std::int64_t faults = 0;       ///< of the result
  std::optional<Error> refusal;  ///< the first one

  bool is_good() const { return result && faults == 0; }
  /// Returns whether the undeformed source reaches into the target, whatever opens it.
  bool reaches_in() const {
    return result && std::any_of(result->notes.begin(), result->notes.end(), [](const Note& note) {
             return note.id() == facts::merge::SourceReachesIn::id;
           });
  }
  void take(DropResult dropped, std::size_t index) {
    const std::int64_t found = count_faults(dropped);
    if (result && found >= faults) return;
    result = std::move(dropped);
    faults = found;
    plane = index;
  }
};

/// Opens a closed source at its base and drops it. As long as the drop is refused or the result intersects
/// itself, further planes of the side that it stands on are tried, then smaller sizes by the best plane, then
/// another side.
DropResult drop_closed_source(const Mesh& target, const Mesh& source, const Drop& drop,
                              const MergeOptions& options, const Context& context) {
  context.step("open");
  Index pieces = 0;
  connected_components(source, &pieces);
  if (pieces > 1) throw Error(facts::merge::ClosedSourceInPieces{.pieces = pieces}, "base");
  const BaseSearch search(source, drop.base);
  const std::vector<BasePlane>& planes = search.planes();
  BestDrop best;
  const auto try_plane = [&](std::size_t plane, int most_tries) {
    try {
      const OpenedSource opened = search.open(planes[plane], context);
      const int tries = most_tries == 0 || opened.loops.size() == 1 ? most_tries : 2 * most_tries;
      best.take(drop_opened(target, source, opened, drop, options, tries, context), plane);
    } catch (const Error& error) {
      if (error.code() == ErrorCode::cancelled) throw;
      if (!best.refusal) best.refusal = error;
    }
  };
  const auto stands = [&](std::size_t plane) {  // on the first side
    return planes[plane].plane.normal == planes.front().plane.normal;
  };
  for (const bool standing : {true, false}) {
    for (std::size_t plane = 0; plane < planes.size() && !best.is_good() && !best.reaches_in(); ++plane)
      if (stands(plane) == standing) try_plane(plane, 0);
    if (!best.is_good() && !best.reaches_in() && stands(best.plane) == standing)
      try_plane(best.plane, most_size_tries);
  }
  if (!best.result) throw Error(*best.refusal);
  DropResult& found = *best.result;
  if (!stands(best.plane))
    found.notes.push_back(facts::merge::LaidOnAnotherSide{});
  else if (found.base->loops < planes.front().loops)
    found.notes.push_back(facts::merge::FewerFeetUsed{.feet = planes.front().loops, .used = found.base->loops});
  return std::move(found);
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
  if (find_conflict({.pose = options.pose, .dropped = true}))
    throw Error(facts::merge::DroppedPoseKept{}, "pose");
  if (drop.source_loop.empty()) return drop_closed_source(target, source, drop, options, context);
  if (!drop.base.is_automatic()) throw Error(facts::merge::BaseWithSourceLoop{}, "base");
  return drop_open_source(target, source, {drop.source_loop}, drop, options, most_size_tries, context);
}

}  // namespace meshgraft
