#include <algorithm>
#include <map>
#include <numeric>
#include <optional>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <meshgraft/core/error.h>
#include <meshgraft/merge/drop.h>
#include <meshgraft/merge/merge.h>
#include <meshgraft/merge/pose_source.h>
#include <meshgraft/mesh/set_aside.h>

#include "../core/stopwatch.h"
#include "run_steps.h"
#include "selection_resolver.h"

namespace meshgraft {

namespace {

// One of the two meshes, as a step sees it.
struct Side {
  std::string name;  // "source" or "target", as fields and messages call it
  const Scene& scene;
  SetAside usable;  // what is merged; loops and selections are the scene's
  SelectionContext context;
  SelectionResolver selections;

  Side(std::string name_, const EditFile& edit, const Scene& scene_)
      : name(std::move(name_)),
        scene(scene_),
        usable(scene.mesh, scene.triage, scene.label),
        context(scene.mesh),
        selections(edit, context, scene.produced) {}

  // Refuses a vertex that is meant by its number and has no place, or a bad face.
  void require_usable(Index vertex, const std::string& place) const {
    try {
      usable.require_beyond(std::vector<Index>{vertex});
    } catch (const Error& error) {
      throw error.within(place);
    }
  }

  // The vertices that the merge removed, or that faces of the seam have.
  std::vector<Index> reached(const IndexMap& map, const Mesh& result,
                             const std::vector<Index>& new_faces) const {
    std::vector<char> at_seam(result.vertex_count(), 0);
    for (const Index face : new_faces)
      for (const Index v : result.faces[face]) at_seam[v] = 1;
    std::vector<Index> vertices;
    for (Index v = 0; v < scene.mesh.vertex_count(); ++v) {
      const Index now = map.new_index[v];
      if (scene.mesh.positions.row(v).allFinite() && (now < 0 || at_seam[now])) vertices.push_back(v);
    }
    return vertices;
  }

  // Once it is merged: nothing that was left out may lie where the result is new.
  void finish(const IndexMap& map, MergeResult& result, std::vector<std::string>& notes) const {
    if (!usable.any()) return;
    usable.require_beyond(reached(map, result.mesh, result.new_faces));
    usable.put_back(map, result.mesh);
    if (std::string note = usable.note(); !note.empty()) notes.push_back(std::move(note));
  }
};

std::string loop_list(const Side& side) {
  std::string list;
  constexpr std::size_t most = 8;
  const auto& loops = side.context.loops;
  for (std::size_t k = 0; k < std::min(most, loops.size()); ++k)
    list += fmt::format("{}{} ({} vertices)", k == 0 ? "" : ", ", k, loops[k].size());
  return loops.size() > most ? list + ", …" : list;
}

void require_loops(const Side& side, const std::string& place) {
  if (!side.context.loops.empty()) return;
  const std::string name = fmt::format("the {} ({})", side.name, side.scene.label);
  if (side.scene.mesh.face_count() == 0)
    throw Error(ErrorCode::input, name + " has no faces", place, "Export it with its faces.");
  if (const Finding* edges = side.scene.triage.find("non-manifold-edge"))
    throw Error(ErrorCode::input,
                fmt::format("{} has no closed boundary loop: {}, first at vertex {}", name, edges->description,
                            edges->indices.front()),
                place, edges->remedy);
  throw Error(ErrorCode::input, name + " has no boundary loop", place, "Cut it open first: 'meshgraft cut'.");
}

// Refuses a loop along which the surface is no oriented manifold: nothing can be welded there.
void require_sound(const Side& side, std::size_t number, const std::string& place) {
  const std::vector<Index>& loop = side.context.loops[number];
  for (const char* defect : {"non-manifold-edge", "non-manifold-vertex", "inconsistent-winding"}) {
    const Finding* finding = side.scene.triage.find(defect);
    if (!finding) continue;
    std::vector<Index> here;
    for (const Index v : loop)
      if (std::binary_search(finding->indices.begin(), finding->indices.end(), v)) here.push_back(v);
    if (here.empty()) continue;
    constexpr std::size_t most = 6;
    std::sort(here.begin(), here.end());
    const std::string more = here.size() > most ? ", …" : "";
    here.resize(std::min(most, here.size()));
    throw Error(ErrorCode::input,
                fmt::format("loop {} of the {} ({}) cannot be merged: {}, on the loop at vertices {}{}", number,
                            side.name, side.scene.label, finding->description, fmt::join(here, ", "), more),
                place, finding->remedy);
  }
}

// The boundary loop that has exactly the selected vertices.
std::size_t loop_of(Side& side, const SelectionSpec& spec, const std::string& place) {
  require_loops(side, place);
  const auto& loops = side.context.loops;
  if (const auto* loop = std::get_if<Selection::Loop>(&spec.kind)) {
    if (loop->number >= 0 && static_cast<std::size_t>(loop->number) < loops.size())
      return static_cast<std::size_t>(loop->number);
    throw Error(ErrorCode::input, fmt::format("the {} has no boundary loop {}", side.name, loop->number), place,
                fmt::format("Its loops are {}.", loop_list(side)));
  }
  const std::vector<Index> wanted = side.selections.vertices(spec, place);
  for (std::size_t k = 0; k < loops.size(); ++k) {
    if (loops[k].size() != wanted.size()) continue;
    std::vector<Index> sorted = loops[k];
    std::sort(sorted.begin(), sorted.end());
    if (sorted == wanted) return k;
  }
  const auto is_on_boundary = [&](Index v) {
    return std::any_of(loops.begin(), loops.end(),
                       [&](const auto& loop) { return std::find(loop.begin(), loop.end(), v) != loop.end(); });
  };
  const auto stray = std::find_if_not(wanted.begin(), wanted.end(), is_on_boundary);
  const std::string problem =
      stray != wanted.end()
          ? fmt::format("vertex {} is not on a boundary of the {}", *stray, side.name)
          : fmt::format("the {} selected vertices are not those of one boundary loop of the {}", wanted.size(),
                        side.name);
  throw Error(ErrorCode::input, problem, place, fmt::format("Its loops are {}.", loop_list(side)));
}

// The boundary loop that a matched vertex lies on.
std::size_t loop_through(const Side& side, Index vertex, const std::string& place) {
  require_loops(side, place);
  const auto& loops = side.context.loops;
  for (std::size_t k = 0; k < loops.size(); ++k)
    if (std::find(loops[k].begin(), loops[k].end(), vertex) != loops[k].end()) return k;
  throw Error(ErrorCode::input,
              vertex < side.scene.mesh.vertex_count()
                  ? fmt::format("vertex {} is not on a boundary of the {}", vertex, side.name)
                  : fmt::format("there is no vertex {} among the {}'s {}", vertex, side.name,
                                side.scene.mesh.vertex_count()),
              place, fmt::format("Its loops are {}.", loop_list(side)));
}

// Of some vertices, the one nearest to a point.
Index nearest(const Mesh& mesh, std::span<const Index> vertices, const Eigen::Vector3d& point) {
  const Points& positions = mesh.positions;
  return *std::min_element(vertices.begin(), vertices.end(), [&](Index a, Index b) {
    return (positions.row(a) - point.transpose()).squaredNorm() <
           (positions.row(b) - point.transpose()).squaredNorm();
  });
}

// The vertex of a loop that is meant, or of any loop.
Index loop_vertex(const Side& side, const VertexSpec& vertex, std::optional<std::size_t> loop,
                  const std::string& place) {
  if (const auto* number = std::get_if<Index>(&vertex)) return *number;
  require_loops(side, place);
  std::vector<Index> candidates;
  for (std::size_t k = 0; k < side.context.loops.size(); ++k)
    if (!loop || k == *loop)
      candidates.insert(candidates.end(), side.context.loops[k].begin(), side.context.loops[k].end());
  return nearest(side.scene.mesh, candidates, std::get<Eigen::Vector3d>(vertex));
}

/// Loops that meet, by their numbers.
struct LoopNumbers {
  std::size_t source = 0, target = 0;
  std::vector<Match> matches;
};

std::vector<LoopNumbers> listed_pairs(const MergeStep& step, Side& source, Side& target,
                                      const std::string& place) {
  std::vector<LoopNumbers> pairs;
  for (std::size_t i = 0; i < step.pairs.size(); ++i) {
    const std::string where = fmt::format("{}.pairs[{}]", place, i);
    pairs.push_back({loop_of(source, step.pairs[i].source_loop, where + ".source_loop"),
                     loop_of(target, step.pairs[i].target_loop, where + ".target_loop"),
                     {}});
    LoopNumbers& pair = pairs.back();
    for (const MatchSpec& match : step.pairs[i].matches)
      pair.matches.push_back({loop_vertex(source, match.source, pair.source, where),
                              loop_vertex(target, match.target, pair.target, where)});
  }
  return pairs;
}

// Puts each match of the step to the pair on whose loops it lies; makes that pair where none is listed.
void add_matches(const MergeStep& step, const Side& source, const Side& target, std::vector<LoopNumbers>& pairs,
                 const std::string& place) {
  for (std::size_t i = 0; i < step.matches.size(); ++i) {
    const std::string where = fmt::format("{}.matches[{}]", place, i);
    const Match match{loop_vertex(source, step.matches[i].source, {}, where),
                      loop_vertex(target, step.matches[i].target, {}, where)};
    const std::size_t from = loop_through(source, match.source, where);
    const std::size_t to = loop_through(target, match.target, where);
    auto pair = std::find_if(pairs.begin(), pairs.end(),
                             [&](const LoopNumbers& p) { return p.source == from || p.target == to; });
    if (pair == pairs.end() && step.pairs.empty()) pair = pairs.insert(pairs.end(), {from, to, {}});
    if (pair == pairs.end() || pair->source != from || pair->target != to)
      throw Error(
          ErrorCode::input,
          fmt::format("it joins loop {} of the target and loop {} of the source, which are no pair", to, from),
          where);
    pair->matches.push_back(match);
  }
}

std::vector<MergePair> resolve_pairs(const MergeStep& step, Side& source, Side& target,
                                     const std::string& place) {
  std::vector<LoopNumbers> numbers = listed_pairs(step, source, target, place);
  add_matches(step, source, target, numbers, place);
  if (numbers.empty()) {
    for (const Side* side : {&target, &source}) require_loops(*side, place);
    if (source.context.loops.size() != 1 || target.context.loops.size() != 1)
      throw Error(ErrorCode::input,
                  fmt::format("which loops meet is not clear: the target has the loops {}, the source has {}",
                              loop_list(target), loop_list(source)),
                  place,
                  "Say so with 'pairs' ('--pair TARGET_LOOP:SOURCE_LOOP'), or match a vertex of each loop.");
    numbers.push_back({});
  }
  for (std::size_t i = 0; i < numbers.size(); ++i) {
    const std::string where = numbers.size() == 1 ? place : fmt::format("{}.pairs[{}]", place, i);
    require_sound(source, numbers[i].source, where);
    require_sound(target, numbers[i].target, where);
  }
  std::vector<MergePair> pairs;
  for (LoopNumbers& pair : numbers)
    pairs.push_back(
        {{source.context.loops[pair.source], target.context.loops[pair.target]}, std::move(pair.matches)});
  return pairs;
}

void require_counts(const MergeCounts& expected, const Side& source, const Side& target,
                    const std::vector<MergePair>& pairs, std::size_t fixed, const std::string& place) {
  const auto require = [&](const char* name, const std::optional<Index>& count, std::size_t found) {
    if (count && static_cast<std::size_t>(*count) != found)
      throw Error(ErrorCode::input, fmt::format("{} expected, {} found", *count, found),
                  fmt::format("{}.counts.{}", place, name), "Is it the right mesh?");
  };
  const auto require_sizes = [&](const char* name, const std::vector<Index>& sizes, auto size_of) {
    if (sizes.empty()) return;
    require(name, static_cast<Index>(sizes.size()), pairs.size());
    for (std::size_t i = 0; i < sizes.size(); ++i) require(name, sizes[i], size_of(pairs[i].loops));
  };
  const auto size = [](Index count) { return static_cast<std::size_t>(count); };
  require("source_vertices", expected.source_vertices, size(source.scene.mesh.vertex_count()));
  require("source_faces", expected.source_faces, size(source.scene.mesh.face_count()));
  require("target_vertices", expected.target_vertices, size(target.scene.mesh.vertex_count()));
  require("target_faces", expected.target_faces, size(target.scene.mesh.face_count()));
  require_sizes("source_loops", expected.source_loops, [](const LoopPair& pair) { return pair.source.size(); });
  require_sizes("target_loops", expected.target_loops, [](const LoopPair& pair) { return pair.target.size(); });
  require("fixed", expected.fixed, fixed);
  std::size_t free = size(source.scene.mesh.vertex_count()) - fixed;
  for (const MergePair& pair : pairs) free -= std::min(free, pair.loops.source.size());
  require("free", expected.free, free);
}

// What the step asks of `merge`, but for lengths of the source before it was posed.
MergeOptions resolve_options(const MergeStep& step, Side& source, const SettingsOverrides& overrides,
                             const std::string& place) {
  MergeOptions options;
  options.pose = step.pose;
  options.shape = overrides.shape.value_or(step.shape);
  options.reach = step.reach;
  if (step.fixed) {
    options.fixed = source.selections.vertices(*step.fixed, place + ".fixed");
    if (options.fixed.empty())
      throw Error(ErrorCode::input, "it selects no vertex of the source", place + ".fixed",
                  "Name some, or leave it out: then the part beyond reach stays");
  }
  for (std::size_t i = 0; i < step.features.size(); ++i)
    options.features.push_back(
        {source.selections.vertices(step.features[i].select, fmt::format("{}.features[{}].select", place, i)),
         step.features[i].similarity});
  options.size = step.size;
  options.normal_angle_deg = step.normal_angle_deg;
  options.smooth_boundary = step.smooth_boundary;
  options.fix_winding = step.fix_winding;
  options.deformer = effective_options(step.settings.deformer, overrides);
  if (options.shape == MergeShape::ft05)
    options.deformer.method = DeformMethod::ft05;  // which is what it means
  options.seam = step.settings.seam;
  return options;
}

// A vertex by its number, or the one of all that is nearest to a point.
Index any_vertex(const Mesh& mesh, const VertexSpec& vertex) {
  if (const auto* number = std::get_if<Index>(&vertex)) return *number;
  std::vector<Index> all(static_cast<std::size_t>(mesh.vertex_count()));
  std::iota(all.begin(), all.end(), Index{0});
  return nearest(mesh, all, std::get<Eigen::Vector3d>(vertex));
}

// How the step poses the source before it is merged.
Eigen::Affine3d posing_of(const MergeStep& step, const Mesh& source, const Mesh& target,
                          const std::string& place) {
  Eigen::Affine3d map = Eigen::Affine3d::Identity();
  if (step.mirror) map = reflection(*step.mirror, place + ".mirror");
  if (step.source_transform) map = Eigen::Affine3d(*step.source_transform) * map;
  if (step.align.empty()) return map;
  Mesh mirrored;
  mirrored.positions = (source.positions * map.linear().transpose()).rowwise() + map.translation().transpose();
  std::vector<Match> pairs;
  for (const MatchSpec& pair : step.align)
    pairs.push_back({any_vertex(source, pair.source), any_vertex(target, pair.target)});
  return align_source(mirrored, target, pairs, place + ".align") * map;
}

Mesh posed(const Mesh& source, const Eigen::Affine3d& map, const std::string& place) {
  if (map.matrix() == Eigen::Matrix4d::Identity()) return source;
  return transformed(source, map, place + ".source_transform");
}

// The source's loop that is dropped on the target.
std::size_t dropped_loop(const DropSpec& drop, Side& source, const std::string& place) {
  if (drop.source_loop) return loop_of(source, *drop.source_loop, place + ".source_loop");
  require_loops(source, place);
  if (source.context.loops.size() != 1)
    throw Error(ErrorCode::input,
                fmt::format("which loop of the source meets the target is not clear: it has the loops {}",
                            loop_list(source)),
                place, "Name one with 'source_loop' ('--source-loop LOOP').");
  return 0;
}

// The error of a library call, at the field of the step that it is about.
Error placed(const Error& error, const std::string& place) {
  const std::string& inner = error.place();
  if (inner.starts_with("pair "))
    return Error(error.code(), error.problem(), fmt::format("{}.pairs[{}]", place, inner.substr(5)),
                 error.remedy());
  if (inner == "place") return Error(error.code(), error.problem(), place + ".at", error.remedy());
  for (const char* field : {"size", "normal_angle_deg", "reach", "fixed", "features"})
    if (inner == field) return Error(error.code(), error.problem(), place + "." + inner, error.remedy());
  return error.within(place);
}

void judge_intersections(const MergeIntersections& found, const MergeStep& step, bool strict,
                         std::vector<std::string>& notes, const std::string& place) {
  if (!found.any_new()) return;
  const std::string problem = fmt::format("{} pairs of faces of the result intersect", *found.result);
  const std::string remedy = step.at ? "place, spin or size may help" : "start, size or shape may help";
  if (strict) throw Error(ErrorCode::unsolvable, problem, place, "Another " + remedy);
  notes.push_back(problem + "; another " + remedy);
}

std::vector<Index> present(const IndexMap& map, Index count) {
  std::vector<Index> vertices;
  for (Index v = 0; v < count; ++v)
    if (map.new_index[static_cast<std::size_t>(v)] >= 0)
      vertices.push_back(map.new_index[static_cast<std::size_t>(v)]);
  std::sort(vertices.begin(), vertices.end());
  return vertices;
}

std::vector<Index> seam_vertices(const Mesh& mesh, const std::vector<Index>& faces) {
  std::vector<Index> vertices;
  for (const Index face : faces)
    vertices.insert(vertices.end(), mesh.faces[face].begin(), mesh.faces[face].end());
  std::sort(vertices.begin(), vertices.end());
  vertices.erase(std::unique(vertices.begin(), vertices.end()), vertices.end());
  return vertices;
}

// The merged mesh, with all that later steps may name on it.
Scene merged_scene(MergeResult& result, const EditStep& step, const Scene& target, const Scene& source,
                   const Context& context) {
  ProducedSets produced;
  carry_produced(source.produced, result.source, produced);
  carry_produced(target.produced, result.target, produced);
  if (!step.name.empty())
    produced[step.name] = {{"target", present(result.target, target.mesh.vertex_count())},
                           {"source", present(result.source, source.mesh.vertex_count())},
                           {"seam", seam_vertices(result.mesh, result.new_faces)}};
  Scene scene =
      make_scene(std::move(result.mesh), fmt::format("{} with {}", target.label, source.label), context);
  scene.produced = std::move(produced);
  return scene;
}

void take_seconds(const MergeReport& report, StageSeconds& seconds) {
  seconds.match = report.match_seconds;
  seconds.assemble = report.assemble_seconds;
  seconds.factorise = report.factorise_seconds;
  seconds.solve = report.solve_seconds;
  seconds.seam = report.seam_seconds;
}

}  // namespace

Eigen::Affine3d drop_stand(const EditFile& edit, const MergeStep& step, const std::string& place,
                           const Scene& target_scene, const Scene& source_scene) {
  Side source("source", edit, source_scene), target("target", edit, target_scene);
  const std::vector<Index>& loop = source.context.loops[dropped_loop(*step.at, source, place + ".at")];
  try {
    const Eigen::Affine3d posing = posing_of(step, source.usable.mesh(), target.usable.mesh(), place);
    const Drop drop{step.at->place, step.size, step.at->spin_deg};
    return drop_pose(target.usable.mesh(), posed(source.usable.mesh(), posing, place), loop, drop) * posing;
  } catch (const Error& error) {
    throw placed(error, place);
  }
}

StepReport run_merge(const EditFile& edit, const EditStep& edit_step, const std::string& place,
                     std::map<std::string, Scene>& scenes, const RunOptions& options, const Context& context) {
  const auto& step = std::get<MergeStep>(edit_step.action);
  Stopwatch watch;
  StepReport report;
  report.mesh = step.target;
  report.result = outcome_of(edit_step);
  MergeOutcome& outcome = report.merge.emplace();
  outcome.source = step.source;

  context.step("select");
  Side source("source", edit, scenes.at(step.source)), target("target", edit, scenes.at(step.target));
  std::vector<MergePair> pairs;
  if (step.at)
    pairs.push_back({{source.context.loops[dropped_loop(*step.at, source, place + ".at")], {}}, {}});
  else
    pairs = resolve_pairs(step, source, target, place);
  outcome.options = resolve_options(step, source, options.overrides, place);
  require_counts(step.counts, source, target, pairs, outcome.options.fixed.size(), place);
  for (const MatchSpec& pair : step.align) {
    if (const auto* number = std::get_if<Index>(&pair.source)) source.require_usable(*number, place + ".align");
    if (const auto* number = std::get_if<Index>(&pair.target)) target.require_usable(*number, place + ".align");
  }
  if (step.at)
    if (const auto* number = std::get_if<Index>(&step.at->place)) target.require_usable(*number, place + ".at");
  for (const MergePair& pair : pairs) {
    source.usable.require_beyond(pair.loops.source);
    target.usable.require_beyond(pair.loops.target);
  }
  outcome.posing = posing_of(step, source.usable.mesh(), target.usable.mesh(), place);
  if (outcome.options.reach.length)
    *outcome.options.reach.length *= std::cbrt(std::abs(outcome.posing.linear().determinant()));
  const Mesh part = posed(source.usable.mesh(), outcome.posing, place);
  report.seconds.select = watch.lap();

  MergeResult result;
  MergeIntersections intersections;
  try {
    if (step.at) {
      const Drop drop{step.at->place, step.size, step.at->spin_deg};
      DropResult dropped =
          drop_part(target.usable.mesh(), part, pairs.front().loops.source, drop, outcome.options, context);
      result = std::move(dropped.merge);
      outcome.options = dropped.options;
      report.notes = std::move(dropped.notes);
      intersections = dropped.intersections;
    } else {
      result = merge_meshes(target.usable.mesh(), part, pairs, outcome.options, context);
      const Stopwatch measuring;
      intersections = count_intersections(part, result, context);
      report.seconds.measure = measuring.seconds();
    }
  } catch (const Error& error) {
    if (error.code() == ErrorCode::cancelled) throw;
    throw placed(target.usable.explained(source.usable.explained(error)), place);
  }
  // What remains is the hole's, and that of sizes that were tried before.
  report.seconds.select += std::max(0.0, watch.lap() - result.report.total_seconds - report.seconds.measure);
  source.finish(result.source, result, report.notes);
  target.finish(result.target, result, report.notes);
  take_seconds(result.report, report.seconds);
  outcome.report = std::move(result.report);
  outcome.target_map = result.target;
  outcome.source_map = result.source;
  outcome.new_faces = result.new_faces;
  outcome.grafted = std::move(result.grafted);
  report.notes.insert(report.notes.end(), outcome.report.notes.begin(), outcome.report.notes.end());
  outcome.self_intersections = intersections.result;
  outcome.source_self_intersections = intersections.source;
  if (options.strict && !outcome.report.seam.manifold)
    throw Error(ErrorCode::unsolvable, "the result is not a manifold", place,
                "`meshgraft info` tells whether one of the two meshes was not");
  judge_intersections(intersections, step, options.strict, report.notes, place);

  report.counts.vertices = result.mesh.vertex_count();
  report.counts.faces = result.mesh.face_count();
  scenes.insert_or_assign(report.result, merged_scene(result, edit_step, target.scene, source.scene, context));
  report.seconds.triage = watch.lap();
  report.seconds.total = watch.seconds();
  return report;
}

}  // namespace meshgraft
