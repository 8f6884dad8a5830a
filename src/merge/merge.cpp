#include <meshgraft/merge/merge.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <set>
#include <utility>

#include <meshgraft/core/error.h>
#include <meshgraft/mesh/cut.h>
#include <meshgraft/mesh/normals.h>
#include <meshgraft/mesh/refine.h>
#include <meshgraft/mesh/topology.h>
#include <meshgraft/mesh/winding.h>

#include "../core/stopwatch.h"
#include "../mesh/box_diagonal.h"
#include "boundary_condition.h"
#include "core/facts.h"
#include "graft.h"
#include "loops.h"
#include "merge/facts.h"
#include "open_start.h"
#include "shape_report.h"

namespace meshgraft {

std::string_view to_string(MergePose value) {
  switch (value) {
    case MergePose::find: return "find";
    case MergePose::keep: return "keep";
  }
  return "";
}

std::string_view to_string(MergeShape value) {
  switch (value) {
    case MergeShape::ft05: return "ft05";
    case MergeShape::similar: return "similar";
  }
  return "";
}

namespace {

void validate_options(const MergeOptions& options, const Mesh& source, const Mesh& target) {
  const auto require = [](bool good, const auto& fact, const char* field) {
    if (!good) throw Error(fact, field);
  };
  if (options.size) {
    constexpr double extreme = 1e6;
    const double same =
        box_diagonal(target.positions) / box_diagonal(source.positions);  // makes both equally large
    require(*options.size > 0, facts::core::NotPositive{.value = *options.size}, "size");
    require(!(*options.size < same / extreme),
            facts::merge::SizeMakesSourceTiny{.size = *options.size, .same_size = same}, "size");
    require(!(*options.size > same * extreme),
            facts::merge::SizeMakesSourceHuge{.size = *options.size, .same_size = same}, "size");
  }
  require(std::abs(options.normal_angle_deg) <= 180,
          facts::core::OutOfRange{.value = options.normal_angle_deg, .low = -180, .high = 180},
          "normal_angle_deg");
  if (const auto rings = options.reach.rings)
    require(*rings >= 1, facts::merge::ReachLessThanOneRing{.rings = *rings}, "reach");
  if (const auto length = options.reach.length)
    require(*length > 0, facts::core::NotPositive{.value = *length}, "reach");
  require(!(options.reach.rings && options.reach.length), facts::merge::ReachGivenTwice{}, "reach");
  require(options.fixed.empty() || options.pose == MergePose::keep, facts::merge::FixedWhilePoseFound{},
          "fixed");
  for (const Index v : options.fixed)
    require(v >= 0 && v < source.vertex_count(),
            facts::merge::NoSuchVertex{.role = "source", .vertex = v, .count = source.vertex_count()}, "fixed");
}

/// The source during a merge: refined at its loops, and turned over where necessary.
struct Source {
  Mesh mesh;
  std::vector<LoopPair> pairs;
  Index added = 0;
};

/// Returns the vertices of a refined loop: the old ones and, between them, those that halve its edges.
std::vector<Index> refined_loop(const std::vector<Index>& loop,
                                const std::map<std::array<Index, 2>, Index>& middle) {
  std::vector<Index> refined;
  for (std::size_t i = 0; i < loop.size(); ++i) {
    const auto [low, high] = std::minmax(loop[i], loop[(i + 1) % loop.size()]);
    refined.push_back(loop[i]);
    if (const auto found = middle.find({low, high}); found != middle.end()) refined.push_back(found->second);
  }
  return refined;
}

void take_refined(Source& source, RefineResult refined) {
  std::map<std::array<Index, 2>, Index> middle;
  for (std::size_t k = 0; k < refined.parents.size(); ++k) {
    const auto [low, high] = std::minmax(refined.parents[k][0], refined.parents[k][1]);
    middle[{low, high}] = source.mesh.vertex_count() + static_cast<Index>(k);
  }
  source.added += static_cast<Index>(refined.parents.size());
  source.mesh = std::move(refined.mesh);
  for (LoopPair& pair : source.pairs) pair.source = refined_loop(pair.source, middle);
}

/// Halves the source's edges around loops that have less than 1/ratio as many vertices as their target loops
/// (design: "few boundary vertices for a large region").
void refine_source(Source& source, double ratio, const Context& context) {
  constexpr int around = 2, most_levels = 6;
  for (int level = 0; level < most_levels; ++level) {
    const IndexLists rings = vertex_rings(source.mesh.vertex_count(), source.mesh.faces);
    std::vector<Index> coarse;
    for (const LoopPair& pair : source.pairs) {
      if (static_cast<double>(pair.target.size()) <= ratio * static_cast<double>(pair.source.size())) continue;
      const std::vector<Index> vertices = grow_rings(pair.source, around, rings);
      coarse.insert(coarse.end(), vertices.begin(), vertices.end());
    }
    if (coarse.empty()) return;
    take_refined(source, split_edges_within(source.mesh, coarse, context));
  }
}

/// Halves the source's edges within its loops' radii that are too long for the source to bend there. Edges of
/// a loop are halved only where the loop has very few vertices.
void refine_within_reach(Source& source, const Context& context) {
  constexpr double longest_rel = 0.35;  // × the loop's radius
  constexpr std::size_t fewest_around = 12;
  constexpr int most_levels = 6;
  for (int level = 0; level < most_levels; ++level) {
    const Points& points = source.mesh.positions;
    const IndexLists rings = vertex_rings(source.mesh.vertex_count(), source.mesh.faces);
    std::vector<double> longest(static_cast<std::size_t>(points.rows()),
                                std::numeric_limits<double>::infinity());
    Flags keeps_its_loop(longest.size(), false);
    for (const LoopPair& pair : source.pairs) {
      const double radius = loop_radius(points, pair.source);
      const std::vector<double> distance = edge_distance(pair.source, points, rings, {.limit = radius});
      for (std::size_t v = 0; v < longest.size(); ++v)
        if (distance[v] <= radius) longest[v] = std::min(longest[v], longest_rel * radius);
      for (const Index v : pair.source) keeps_its_loop[v] = pair.source.size() >= fewest_around;
    }
    const auto is_long = [&](Index a, Index b) {
      return !(keeps_its_loop[a] && keeps_its_loop[b]) &&
             (points.row(a) - points.row(b)).norm() > std::min(longest[a], longest[b]);
    };
    RefineResult refined = split_edges(source.mesh, is_long, context);
    if (refined.parents.empty()) return;
    take_refined(source, std::move(refined));
  }
}

/// Calls `match_automatically` for some of the pairs. Where starts are ambiguous, appends them to `open` with
/// their indices among all pairs, and returns correspondences that are not to be used.
std::vector<Correspondence> match_members(const std::vector<std::size_t>& members,
                                          std::span<const LoopPair> pairs,
                                          std::span<const LoopGeometry> sources,
                                          std::span<const LoopGeometry> targets, bool posed,
                                          std::span<const std::string> locations,
                                          std::vector<OpenStart>& open) {
  try {
    return match_automatically(pairs, sources, targets, posed, locations);
  } catch (const Error& error) {
    if (error.id() != facts::merge::OpenStart::id) throw;
    for (OpenStart start : open_starts(error.fact())) {
      start.pair = members[start.pair];
      open.push_back(start);
    }
    return std::vector<Correspondence>(members.size());
  }
}

/// Returns one correspondence per pair. It follows the pair's matches where there are any. Else it is found
/// automatically, for each component of the source over all its pairs without matches. Throws
/// Error(input) with the id merge.open_start, which lists the ambiguous pairs of all components.
std::vector<Correspondence> match_loops(std::span<const LoopPair> loops, std::span<const MergePair> pairs,
                                        std::span<const LoopGeometry> sources,
                                        std::span<const LoopGeometry> targets,
                                        const std::vector<Index>& component, bool posed) {
  std::vector<Correspondence> found(loops.size());
  std::map<Index, std::vector<std::size_t>> unmatched;  // by component
  for (std::size_t p = 0; p < loops.size(); ++p) {
    if (pairs[p].matches.empty()) {
      unmatched[component[loops[p].source.front()]].push_back(p);
    } else {
      found[p] = match_by_arc_length(loops[p], pairs[p].matches, sources[p], targets[p],
                                     pair_location(p, loops.size()));
    }
  }
  std::vector<OpenStart> open;
  for (const auto& [number, members] : unmatched) {
    std::vector<LoopPair> some;
    std::vector<LoopGeometry> some_sources, some_targets;
    std::vector<std::string> some_places;
    for (const std::size_t p : members) {
      some.push_back(loops[p]);
      some_sources.push_back(sources[p]);
      some_targets.push_back(targets[p]);
      some_places.push_back(pair_location(p, loops.size()));
    }
    const std::vector<Correspondence> matched =
        match_members(members, some, some_sources, some_targets, posed, some_places, open);
    for (std::size_t k = 0; k < members.size(); ++k) found[members[k]] = matched[k];
  }
  if (!open.empty()) {
    std::ranges::sort(open, {}, &OpenStart::pair);
    throw Error(open_start_fact(open), pair_location(open.front().pair, loops.size()));
  }
  return found;
}

/// Moves each component near its final pose, because the graft must not depend on the source's pose.
Points posed_by_boundary(const Points& source, const std::vector<Index>& component,
                         std::span<const LoopPair> pairs, std::span<const Correspondence> correspondences,
                         std::optional<double> size, std::vector<LoopGeometry>& sources,
                         std::span<const LoopGeometry> targets) {
  std::map<Index, std::vector<std::size_t>> pairs_of;
  for (std::size_t p = 0; p < pairs.size(); ++p) pairs_of[component[pairs[p].source.front()]].push_back(p);
  Points posed = source;
  for (const auto& [number, members] : pairs_of) {
    std::vector<LoopGeometry> some_sources, some_targets;
    std::vector<Correspondence> some;
    for (const std::size_t p : members) {
      some_sources.push_back(sources[p]);
      some_targets.push_back(targets[p]);
      some.push_back(correspondences[p]);
    }
    const Similarity pose = pose_of_boundary(some_sources, some_targets, some, size);
    const auto bring = [&](const Eigen::RowVector3d& point) {
      return Eigen::RowVector3d(pose.scale * point * pose.rotation.transpose() + pose.translation.transpose());
    };
    for (Index v = 0; v < static_cast<Index>(component.size()); ++v)
      if (component[v] == number) posed.row(v) = bring(source.row(v));
    for (const std::size_t p : members) {
      for (auto point : sources[p].points.rowwise()) point = bring(point);
      sources[p].normals = (sources[p].normals * pose.rotation.transpose()).eval();
    }
  }
  return posed;
}

/// A source ready for the solve.
struct Part {
  const Points& rest;
  const Points& posed;
  const Triangles& triangles;
  const std::vector<Index>& component;
  const std::vector<std::vector<Index>>& loops;
};

/// Returns the fixed vertices without those of the loops, which move to the target's loops.
std::vector<Index> fixed_beside_loops(const std::vector<Index>& fixed,
                                      const std::vector<std::vector<Index>>& loops) {
  std::set<Index> staying(fixed.begin(), fixed.end());
  for (const auto& loop : loops)
    for (const Index v : loop) staying.erase(v);
  if (staying.empty()) throw Error(facts::merge::FixedAllOnLoops{}, "fixed");
  return {staying.begin(), staying.end()};
}

/// Solves within the requested influence radius. Where none is requested and the pose is to be found, the
/// first radius is each loop's own. It is doubled as long as the source is squeezed within it and doubling
/// helps.
Graft graft_within_reach(const Part& part, std::span<const VertexConstraint> constraints,
                         const MergeOptions& options, MergeReport& report, const Context& context) {
  constexpr double roomy = 0.7, better = 0.03, fewest_far = 0.05;
  constexpr int most_doublings = 3;
  constexpr std::size_t most_near = 20000;  // vertices; a larger radius takes many seconds
  const IndexLists rings = vertex_rings(static_cast<Index>(part.rest.rows()), part.triangles, context);
  const bool by_list = options.pose == MergePose::keep && !options.fixed.empty();
  const bool given = options.reach.rings || options.reach.length || options.shape == MergeShape::ft05 ||
                     options.pose == MergePose::keep;
  Graft best;
  std::size_t far_count = 0;
  for (int doubling = 0; doubling <= (given ? 0 : most_doublings); ++doubling) {
    const std::vector<Index> far =
        by_list && !options.reach.rings && !options.reach.length
            ? fixed_beside_loops(options.fixed, part.loops)
            : beyond_reach(part.rest, rings, part.loops, options.reach, 1 << doubling);
    const auto count = static_cast<std::size_t>(part.rest.rows());
    const bool hardly_any = static_cast<double>(far.size()) < fewest_far * static_cast<double>(count);
    if (doubling > 0 && (hardly_any || count - far.size() > most_near || far.size() == far_count)) break;
    far_count = far.size();
    Graft graft = solve_graft(part.posed, part.triangles, constraints, far, part.component, options, context);
    report.assemble_seconds += graft.summary.assemble_seconds;
    report.factorise_seconds += graft.summary.analyse_seconds + graft.summary.factorise_seconds;
    ShapeReport shape = measure_shape(part.rest, graft.positions, part.triangles, far, part.component);
    shape.inverted = graft.evaluation.inverted_maps;
    const bool helps = shape.inverted < report.shape.inverted ||
                       (shape.inverted == report.shape.inverted &&
                        shape.smallest_singular_p5 >= report.shape.smallest_singular_p5 + better);
    if (doubling > 0 && !helps) continue;
    best = std::move(graft);
    report.shape = shape;
    report.evaluation = best.evaluation;
    if (shape.inverted == 0 && shape.smallest_singular_p5 >= roomy) break;
  }
  return best;
}

/// Reports the points of the target's loop that the source's loop vertices meet. Vertices that refinement
/// added are left out.
void report_meetings(const LoopPair& pair, const Correspondence& correspondence, const Points& target,
                     Index given, PairReport& report) {
  report.target_points.resize(static_cast<Eigen::Index>(pair.source.size()), 3);
  for (std::size_t i = 0; i < pair.source.size(); ++i) {
    if (pair.source[i] >= given) continue;
    const double whole = std::floor(correspondence.loop_parameter[i]),
                 t = correspondence.loop_parameter[i] - whole;
    const Eigen::Index k = (static_cast<Eigen::Index>(whole) % target.rows() + target.rows()) % target.rows();
    report.target_points.row(static_cast<Eigen::Index>(report.met.size())) =
        (1 - t) * target.row(k) + t * target.row((k + 1) % target.rows());
    report.met.push_back(pair.source[i]);
  }
  report.target_points.conservativeResize(static_cast<Eigen::Index>(report.met.size()), 3);
}

PairReport report_pair(const LoopPair& pair, const Correspondence& correspondence, const LoopGeometry& source,
                       const LoopGeometry& target) {
  PairReport report;
  report.source_vertices = static_cast<Index>(pair.source.size());
  report.target_vertices = static_cast<Index>(pair.target.size());
  const auto nearest = static_cast<std::size_t>(std::lround(correspondence.loop_parameter.front()));
  report.start = {pair.source.front(), pair.target[nearest % pair.target.size()]};
  report.confidence = correspondence.confidence;
  report.raggedness_deg = std::max(raggedness_deg(source.points), raggedness_deg(target.points));
  // Counts are compared, because matched loops coincide whatever the units of their meshes.
  report.edge_ratio = static_cast<double>(pair.source.size()) / static_cast<double>(pair.target.size());
  return report;
}

/// Returns the distance of a posed loop from its target points, × their radius.
double misfit_rel(const Points& posed, std::span<const VertexConstraint> held) {
  Points there(posed.rows(), 3);
  for (Eigen::Index i = 0; i < there.rows(); ++i)
    there.row(i) = held[static_cast<std::size_t>(i)].position->transpose();
  const Eigen::RowVector3d centre = there.colwise().mean();
  return std::sqrt((posed - there).squaredNorm() / (there.rowwise() - centre).squaredNorm());
}

void add_notes(MergeReport& report, const MergeOptions& options) {
  constexpr double ragged_deg = 25, unsure = 0.4, unlike = 0.25, folded_deg = 60, far_off = 4;
  for (std::size_t p = 0; p < report.pairs.size(); ++p) {
    const PairReport& pair = report.pairs[p];
    if (pair.raggedness_deg > ragged_deg && !options.smooth_boundary)
      report.notes.push_back(facts::merge::BoundaryRagged{.pair = p, .turn_deg = pair.raggedness_deg});
    if (pair.confidence < unsure)
      report.notes.push_back(facts::merge::StartUnsure{
          .pair = p, .confidence = pair.confidence, .target = pair.start.target, .source = pair.start.source});
  }
  for (std::size_t p = 0; p < report.pairs.size(); ++p) {
    const double misfit = report.pairs[p].misfit_rel;
    if (options.pose == MergePose::keep && (misfit > far_off || (misfit > 1 && report.shape.inverted > 0)))
      report.notes.push_back(facts::merge::SourceDrawnOut{.pair = p, .radii = misfit});
    else if (report.seam.dihedral_p99_deg > folded_deg && misfit > unlike)
      report.notes.push_back(facts::merge::LoopsDiffer{
          .pair = p, .difference_percent = 100 * misfit, .bend_deg = report.seam.dihedral_p99_deg});
  }
  constexpr double pinched = 0.3;
  if (report.shape.smallest_singular_p5 < pinched)
    report.notes.push_back(
        facts::merge::SourceSqueezed{.width_percent = 100 * report.shape.smallest_singular_p5});
  if (!report.seam.manifold) report.notes.push_back(facts::merge::ResultNotManifold{});
  if (report.evaluation.fell_back_to_linear) report.notes.push_back(facts::merge::FeaturesBlended{});
  if (report.shape.inverted > 0)
    report.notes.push_back(facts::merge::SourceInverted{.vertices = report.shape.inverted});
}

/// Removes stored cut normals of loops that are no longer open.
void drop_used_cut_normals(Mesh& mesh) {
  const auto kept =
      std::find_if(mesh.attributes.begin(), mesh.attributes.end(), [](const Attribute& attribute) {
        return attribute.domain == Domain::vertex && attribute.name == cut_normal_name;
      });
  if (kept == mesh.attributes.end()) return;
  Flags open(static_cast<std::size_t>(mesh.vertex_count()), 0);
  for (const auto& loop : boundary_loops(mesh))
    for (const Index v : loop) open[v] = 1;
  bool used = false;
  for (std::size_t k = 0; k < kept->values.size(); ++k) {
    if (!open[k / static_cast<std::size_t>(kept->components)])
      kept->values[k] = std::numeric_limits<double>::quiet_NaN();
    used |= std::isfinite(kept->values[k]);
  }
  if (!used) mesh.attributes.erase(kept);
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
  const bool turn = windings_disagree(target, source_mesh);
  if (turn && !options.fix_winding)
    throw Error(
        facts::merge::OrientationsDisagree{.inward = enclosed_volume(target) < 0 ? "target" : "source",
                                           .outward = enclosed_volume(target) < 0 ? "source" : "target"});
  Source source{turn ? turned_over(source_mesh) : source_mesh, {}, 0};
  source.pairs = checked_loops(target, source.mesh, pairs);
  require_held_components(source.mesh, source.pairs);
  refine_source(source, options.seam.edge_ratio, context);
  refine_within_reach(source, context);
  const std::vector<Index> component = connected_components(source.mesh);
  const Points target_normals = vertex_normals(target), source_normals = vertex_normals(source.mesh);
  std::vector<LoopGeometry> sources, targets;
  for (const LoopPair& pair : source.pairs) {
    sources.push_back(loop_geometry(source.mesh, source_normals, pair.source));
    targets.push_back(loop_geometry(target, target_normals, pair.target));
    if (!options.smooth_boundary) continue;
    sources.back().points = smoothed_loop(sources.back().points);
    targets.back().points = smoothed_loop(targets.back().points);
  }
  const std::vector<Correspondence> correspondences =
      match_loops(source.pairs, pairs, sources, targets, component, options.pose == MergePose::keep);
  for (std::size_t p = 0; p < pairs.size(); ++p) {
    report.pairs.push_back(report_pair(source.pairs[p], correspondences[p], sources[p], targets[p]));
    report_meetings(source.pairs[p], correspondences[p], targets[p].points, source_mesh.vertex_count(),
                    report.pairs.back());
  }
  report.match_seconds = watch.lap();

  // Pose the source near the target, then deform it so that its loops meet the target's.
  context.step("graft");
  const bool found = options.pose == MergePose::find;
  const Points posed = found ? posed_by_boundary(source.mesh.positions, component, source.pairs,
                                                 correspondences, options.size, sources, targets)
                             : source.mesh.positions;
  std::vector<VertexConstraint> constraints;
  std::vector<std::vector<Index>> source_loops;
  for (std::size_t p = 0; p < source.pairs.size(); ++p) {
    BoundaryOptions boundary{options.pose, {}, options.normal_angle_deg};
    if (options.size) boundary.scale = found ? 1 : *options.size;
    const auto held =
        boundary_constraints(source.pairs[p], sources[p], targets[p], correspondences[p], boundary);
    report.pairs[p].misfit_rel = misfit_rel(sources[p].points, held);
    constraints.insert(constraints.end(), held.begin(), held.end());
    source_loops.push_back(source.pairs[p].source);
  }
  const Triangles triangles = triangulate(source.mesh, {.skip_out_of_range = true}).triangles;
  const Part part{source.mesh.positions, posed, triangles, component, source_loops};
  const Graft graft = graft_within_reach(part, constraints, options, report, context);
  report.solve_seconds = watch.lap() - report.assemble_seconds - report.factorise_seconds;
  report.source_vertices_added = source.added;

  // Join both meshes.
  context.step("seam");
  Mesh grafted = std::move(source.mesh);
  const Points rest = std::exchange(grafted.positions, graft.positions);
  update_normals(grafted, rest);
  SeamResult seam = make_seam(target, grafted, source.pairs, options.seam, context);
  result.grafted = graft.positions.topRows(source_mesh.vertex_count());
  result.mesh = std::move(seam.mesh);
  drop_used_cut_normals(result.mesh);
  result.target = std::move(seam.target);
  const auto kept = std::count_if(result.target.new_index.begin(), result.target.new_index.end(),
                                  [](Index v) { return v >= 0; });
  report.target_vertices_added = result.mesh.vertex_count() - grafted.vertex_count() - static_cast<Index>(kept);
  result.source = std::move(seam.source);
  result.source.new_index.resize(static_cast<std::size_t>(source_mesh.vertex_count()));  // original ones only
  result.new_faces = std::move(seam.new_faces);
  result.band = std::move(seam.band);
  report.notes = std::move(seam.notes);
  report.seam = seam.report;
  report.seam_seconds = watch.lap();
  add_notes(report, options);
  report.total_seconds = watch.seconds();
  return result;
}

}  // namespace meshgraft
