#include <algorithm>
#include <map>
#include <memory>
#include <numeric>
#include <optional>
#include <utility>

#include <fmt/format.h>

#include <meshgraft/core/error.h>
#include <meshgraft/merge/merge.h>
#include <meshgraft/merge/merge_options.h>

#include "core/stopwatch.h"
#include "merge/open_base.h"
#include "merge/pose_source.h"
#include "merge_sides.h"
#include "run_steps.h"
#include "script/facts.h"

namespace meshgraft {

namespace {

void require_merge_counts(const MergeCounts& expected, const MergeSide& source, const MergeSide& target,
                          const std::vector<MergePair>& pairs, std::size_t fixed, const Location& location) {
  const auto require = [&](const char* name, const std::optional<Index>& count, std::size_t found) {
    if (count && static_cast<std::size_t>(*count) != found)
      throw Error(facts::script::WrongCount{.expected = *count, .found = found}, location / "counts" / name);
  };
  const auto require_sizes = [&](const char* name, const std::vector<Index>& sizes, auto size_of) {
    if (sizes.empty()) return;
    require(name, static_cast<Index>(sizes.size()), pairs.size());
    for (std::size_t i = 0; i < sizes.size(); ++i) require(name, sizes[i], size_of(pairs[i].loops));
  };
  const auto size = [](Index count) { return static_cast<std::size_t>(count); };
  require("source_vertices", expected.source_vertices, size(source.state.mesh.vertex_count()));
  require("source_faces", expected.source_faces, size(source.state.mesh.face_count()));
  require("target_vertices", expected.target_vertices, size(target.state.mesh.vertex_count()));
  require("target_faces", expected.target_faces, size(target.state.mesh.face_count()));
  require_sizes("source_loops", expected.source_loops, [](const LoopPair& pair) { return pair.source.size(); });
  require_sizes("target_loops", expected.target_loops, [](const LoopPair& pair) { return pair.target.size(); });
  require("fixed", expected.fixed, fixed);
  std::size_t free = size(source.state.mesh.vertex_count()) - fixed;
  for (const MergePair& pair : pairs) free -= std::min(free, pair.loops.source.size());
  require("free", expected.free, free);
}

// Returns the options of `merge` for a step, without lengths that refer to the source before it was posed.
MergeOptions resolve_options(const MergeStep& step, MergeSide& source, const SettingsOverrides& overrides,
                             const Location& location) {
  MergeOptions options;
  options.pose = step.pose;
  options.shape = overrides.shape.value_or(overrides.preset ? MergeOptions::as_published().shape : step.shape);
  options.reach = step.reach;
  if (step.fixed) {
    options.fixed = source.selections.vertices(*step.fixed, location / "fixed");
    if (options.fixed.empty()) throw Error(facts::script::FixedEmpty{}, location / "fixed");
  }
  for (std::size_t i = 0; i < step.features.size(); ++i) {
    const Location where = (location / "features")[i] / "select";
    std::vector<Index> vertices = source.selections.vertices(step.features[i].select, where);
    if (vertices.empty()) throw Error(facts::script::SelectionEmpty{}, where);
    options.features.push_back({std::move(vertices), step.features[i].similarity});
  }
  options.size = step.size;
  options.normal_angle_deg = step.normal_angle_deg;
  options.smooth_boundary = step.smooth_boundary;
  options.fix_winding = step.fix_winding;
  options.retry = step.retry;
  const MergeSettings settings = effective_settings(step.settings, overrides);
  options.deformer = settings.deformer;
  if (options.shape == MergeShape::ft05)
    options.deformer.method = DeformMethod::ft05;  // the shape implies the method
  options.seam = settings.seam;
  return options;
}

// Returns a vertex given by its number, or the vertex nearest to a point.
Index any_vertex(const Mesh& mesh, const VertexSpec& vertex) {
  if (const auto* number = std::get_if<Index>(&vertex)) return *number;
  std::vector<Index> all(mesh.vertex_count());
  std::iota(all.begin(), all.end(), Index{0});
  return nearest(mesh, all, std::get<Eigen::Vector3d>(vertex));
}

// Returns the map by which the step poses the source before the merge.
Eigen::Affine3d posing_of(const MergeStep& step, const Mesh& source, const Mesh& target,
                          const Location& location) {
  Eigen::Affine3d map = Eigen::Affine3d::Identity();
  if (step.mirror) map = reflection(*step.mirror, location / "mirror");
  if (step.source_transform) map = Eigen::Affine3d(*step.source_transform) * map;
  if (step.align.empty()) return map;
  Mesh mirrored;
  mirrored.positions = (source.positions * map.linear().transpose()).rowwise() + map.translation().transpose();
  std::vector<Match> pairs;
  for (const MatchSpec& pair : step.align)
    pairs.push_back({any_vertex(source, pair.source), any_vertex(target, pair.target)});
  try {
    return align_source(mirrored, target, pairs) * map;
  } catch (const Error& error) {
    throw error.at(location / "align" / error.location().from(1));
  }
}

Mesh posed(const Mesh& source, const Eigen::Affine3d& map, const Location& location) {
  if (map.matrix() == Eigen::Matrix4d::Identity()) return source;
  return transformed(source, map, location / "source_transform");
}

// Returns orientations of a model in the coordinates to which a map takes it.
std::vector<OrientationGuess> turned(std::vector<OrientationGuess> guesses, const Eigen::Affine3d& map) {
  for (auto& [orientation, probability] : guesses)
    orientation = make_orientation(map.linear() * orientation.up, map.linear() * orientation.front);
  return guesses;
}

// Returns the plane that opens the source, in units of the posed source.
DropBase base_of(const DropSpec& drop, const Eigen::Affine3d& posing) {
  DropBase base = drop.base.value_or(DropBase{});
  if (base.height) *base.height *= std::cbrt(std::abs(posing.linear().determinant()));
  return base;
}

// Returns the error of a library call with the location of the field of the step.
Error placed(const Error& error, const Location& location) {
  const std::vector<LocationPart>& parts = error.location().parts();
  if (!parts.empty() && parts.front().kind == LocationPart::Kind::pair)
    return error.at((location / "pairs")[parts.front().index] / error.location().from(1));
  if (error.location() == "surface_point") return error.at(location / "at");
  if (!parts.empty() && parts.front().name == "base") return error.within(location / "at");
  return error.within(location);
}

void judge_intersections(const MergeIntersections& found, const MergeStep& step, bool strict,
                         std::vector<Note>& notes, const Location& location) {
  using namespace facts::script;
  if (!found.any_new()) return;
  if (strict && step.at) throw Error(StrictDropIntersects{.pairs = found.result}, location);
  if (strict) throw Error(StrictGraftIntersects{.pairs = found.result}, location);
  if (step.at)
    notes.push_back(DropIntersects{.pairs = found.result});
  else
    notes.push_back(GraftIntersects{.pairs = found.result});
}

std::vector<Index> present(const IndexMap& map, Index count) {
  std::vector<Index> vertices;
  for (Index v = 0; v < count; ++v)
    if (map.new_index[v] >= 0) vertices.push_back(map.new_index[v]);
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

// Returns the merged mesh with the sets that later steps may name.
MeshState merged_state(MergeResult& result, const EditStep& step, const MeshState& target,
                       const MeshState& source, const Context& context) {
  ProducedSets produced;
  carry_produced(source.produced, result.source, produced);
  carry_produced(target.produced, result.target, produced);
  if (!step.name.empty())
    produced[step.name] = {{"target", present(result.target, target.mesh.vertex_count())},
                           {"source", present(result.source, source.mesh.vertex_count())},
                           {"seam", seam_vertices(result.mesh, result.new_faces)}};
  MeshState state =
      make_mesh_state(std::move(result.mesh), fmt::format("{} with {}", target.label, source.label), context);
  state.produced = std::move(produced);
  state.orientations = target.orientations;
  return state;
}

void take_seconds(const MergeReport& report, StageSeconds& seconds) {
  seconds.match = report.match_seconds;
  seconds.assemble = report.assemble_seconds;
  seconds.factorise = report.factorise_seconds;
  seconds.solve = report.solve_seconds;
  seconds.seam = report.seam_seconds;
  seconds.retry = report.retry_seconds;
}

}  // namespace

DropPlacement::DropPlacement(const EditFile& edit, const MergeStep& step, const Location& location,
                             const MeshState& target_scene, const MeshState& source_scene)
    : location_(location) {
  MergeSide source(facts::script::Side::source, edit, source_scene),
      target(facts::script::Side::target, edit, target_scene);
  const std::vector<Index> loop = dropped_loop(*step.at, source, location / "at");
  posing_ = posing_of(step, source.sound.mesh(), target.sound.mesh(), location);
  const Mesh part = posed(source.sound.mesh(), posing_, location);
  try {
    const auto shared = std::make_shared<const Mesh>(target.sound.mesh());
    if (!loop.empty()) {
      guide_.emplace(shared, part, std::vector<std::vector<Index>>{loop});
    } else {
      const OpenedSource opened = open_base(part, base_of(*step.at, posing_));
      guide_.emplace(shared, opened.mesh, opened.loops);
    }
  } catch (const Error& error) {
    throw placed(error, location);
  }
}

Eigen::Affine3d DropPlacement::map(const MergeStep& step) const {
  try {
    return guide_->pose({step.at->surface_point, step.size, step.at->spin_deg, {}, {}}) * posing_;
  } catch (const Error& error) {
    throw placed(error, location_);
  }
}

StepReport run_merge(const EditFile& edit, const EditStep& edit_step, const Location& location,
                     std::map<std::string, MeshState>& states, const RunOptions& options,
                     const Context& context) {
  const auto& step = std::get<MergeStep>(edit_step.action);
  Stopwatch watch;
  StepReport report;
  report.mesh = step.target;
  report.result = outcome_of(edit_step);
  MergeOutcome& outcome = report.merge.emplace();
  outcome.source = step.source;

  context.step("select");
  MergeSide source(facts::script::Side::source, edit, states.at(step.source)),
      target(facts::script::Side::target, edit, states.at(step.target));
  std::vector<MergePair> pairs;
  if (step.at)
    pairs.push_back({{dropped_loop(*step.at, source, location / "at"), {}}, {}});
  else
    pairs = resolve_pairs(step, source, target, location);
  outcome.options = resolve_options(step, source, options.overrides, location);
  outcome.preset = effective_settings(step.settings, options.overrides).preset;
  require_merge_counts(step.counts, source, target, pairs, outcome.options.fixed.size(), location);
  for (const MatchSpec& pair : step.align) {
    if (const auto* number = std::get_if<Index>(&pair.source))
      source.require_sound(*number, location / "align");
    if (const auto* number = std::get_if<Index>(&pair.target))
      target.require_sound(*number, location / "align");
  }
  if (step.at)
    if (const auto* number = std::get_if<Index>(&step.at->surface_point))
      target.require_sound(*number, location / "at");
  for (const MergePair& pair : pairs) {
    source.sound.require_beyond(pair.loops.source);
    target.sound.require_beyond(pair.loops.target);
  }
  outcome.posing = posing_of(step, source.sound.mesh(), target.sound.mesh(), location);
  if (outcome.options.reach.length)
    *outcome.options.reach.length *= std::cbrt(std::abs(outcome.posing.linear().determinant()));
  outcome.options.target_orientations = target.state.orientations;
  outcome.options.source_orientations = turned(source.state.orientations, outcome.posing);
  const Mesh part = posed(source.sound.mesh(), outcome.posing, location);
  report.seconds.select = watch.lap();

  MergeResult result;
  try {
    if (step.at) {
      const Drop drop{step.at->surface_point, step.size, step.at->spin_deg, pairs.front().loops.source,
                      base_of(*step.at, outcome.posing)};
      DropResult dropped = drop_source(target.sound.mesh(), part, drop, outcome.options, context);
      result = std::move(dropped.merge);
      outcome.options = dropped.options;
      outcome.base = dropped.base;
      if (outcome.base) outcome.base->height /= std::cbrt(std::abs(outcome.posing.linear().determinant()));
      report.notes = std::move(dropped.notes);
      outcome.intersections = dropped.intersections;
    } else {
      result = merge_meshes(target.sound.mesh(), part, pairs, outcome.options, context);
      if (result.report.retry.normal_angle_deg != 0)
        outcome.options.normal_angle_deg = result.report.retry.normal_angle_deg;
      const Stopwatch measuring;
      outcome.intersections = count_intersections(part, result, context);
      report.seconds.measure = measuring.seconds();
    }
  } catch (const Error& error) {
    if (error.code() == ErrorCode::cancelled) throw;
    throw placed(target.sound.explained(source.sound.explained(error)), location);
  }
  // The remaining seconds were spent on the hole and on sizes that were tried before.
  report.seconds.select += std::max(0.0, watch.lap() - result.report.total_seconds - report.seconds.measure);
  if (options.overrides.method == Method(DeformMethod::shell))
    report.notes.push_back(facts::script::MergeWithoutShell{});
  source.finish(result.source, result, report.notes);
  target.finish(result.target, result, report.notes);
  take_seconds(result.report, report.seconds);
  outcome.report = std::move(result.report);
  outcome.target_map = result.target;
  outcome.source_map = result.source;
  outcome.new_faces = result.new_faces;
  outcome.grafted = std::move(result.grafted);
  report.notes.insert(report.notes.end(), outcome.report.notes.begin(), outcome.report.notes.end());
  if (options.strict && !outcome.report.seam.manifold)
    throw Error(facts::script::StrictNotManifold{}, location);
  judge_intersections(outcome.intersections, step, options.strict, report.notes, location);

  report.counts.vertices = result.mesh.vertex_count();
  report.counts.faces = result.mesh.face_count();
  states.insert_or_assign(report.result, merged_state(result, edit_step, target.state, source.state, context));
  report.seconds.check = watch.lap();
  report.seconds.total = watch.seconds();
  return report;
}

}  // namespace meshgraft
