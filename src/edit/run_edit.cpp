#include <meshgraft/edit/run_edit.h>

#include <algorithm>
#include <map>
#include <numbers>
#include <numeric>
#include <utility>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <meshgraft/baselines/baselines.h>
#include <meshgraft/core/error.h>
#include <meshgraft/core/memory.h>
#include <meshgraft/deform/deformer.h>
#include <meshgraft/deform/memory_estimate.h>
#include <meshgraft/deform/proxy.h>
#include <meshgraft/deform/quality.h>
#include <meshgraft/edit/resolve_deform.h>
#include <meshgraft/io/mesh_io.h>
#include <meshgraft/mesh/normals.h>
#include <meshgraft/mesh/topology.h>
#include <meshgraft/mesh/weld.h>
#include <meshgraft/samples/samples.h>

#include "../core/stopwatch.h"
#include "refine_boundary.h"
#include "run_steps.h"
#include "sha256.h"

namespace meshgraft {

namespace {

// Rings around the region that the solve looks at beyond it: stencils of stencils, and their normals.
int reach_rings(const DeformSettings& settings) { return settings.deformer.operators.laplacian_order + 4; }

void require_hash(const EditInput& input, const std::filesystem::path& path, const std::string& place) {
  if (!input.sha256) return;
  const std::string found = sha256(read_file(path));
  if (found != *input.sha256)
    throw Error(
        ErrorCode::input,
        fmt::format("{} has the SHA-256 {}, the edit was made for {}", path.string(), found, *input.sha256),
        place + ".sha256", "Restore the file, or drop the field if the other one is meant.");
}

std::string label_of(const EditInput& input) {
  if (input.sample.empty()) return input.file;
  return input.resolution == 0 ? "sample " + input.sample
                               : fmt::format("sample {} at resolution {}", input.sample, input.resolution);
}

void require_usable_within_reach(const Scene& scene, const Region& region, const SelectionContext& selections,
                                 int reach) {
  std::vector<Index> vertices = region.vertices;
  if (region.whole) {
    vertices.resize(static_cast<std::size_t>(selections.mesh.vertex_count()));
    std::iota(vertices.begin(), vertices.end(), Index{0});
  }
  vertices = grow_rings(vertices, reach, selections.rings);
  // No equation has what no face has.
  std::erase_if(vertices, [&](Index v) { return selections.components[v] < 0; });
  if (!vertices.empty()) require_usable(scene.triage, selections.mesh, vertices, scene.label);
}

// All that a step holds, vertex by vertex: what stays, what handles hold, what is constrained by itself.
std::vector<VertexConstraint> joined_constraints(const DeformProblem& problem, const Context& context) {
  const Region& region = problem.deform.region;
  const std::vector<HandlePose>& poses = problem.deform.poses;
  Points normals;
  if (std::any_of(poses.begin(), poses.end(), [](const HandlePose& pose) { return pose.curve.has_value(); })) {
    const auto count = static_cast<Index>(problem.rest.rows());
    normals = vertex_normals(problem.rest, problem.triangles,
                             vertex_triangles(count, problem.triangles, context), context);
  }
  std::vector<VertexConstraint> constraints;
  for (const Index v : region.fixed)
    constraints.push_back({v, problem.rest.row(v).transpose(), Eigen::Matrix3d::Identity(),
                           Eigen::AngleAxisd(0, Eigen::Vector3d::UnitZ())});
  for (std::size_t h = 0; h < region.handles.size(); ++h) {
    const auto held = handle_constraints(region.handles[h], poses[h], problem.rest, normals);
    constraints.insert(constraints.end(), held.begin(), held.end());
  }
  constraints.insert(constraints.end(), problem.deform.constraints.begin(), problem.deform.constraints.end());
  return constraints;
}

struct Solution {
  Points positions;  // of the problem's vertices
  std::vector<Index> free;
};

// What a published method solves for: as `Deformer::free_vertices`.
std::vector<Index> free_vertices(const DeformProblem& problem, std::span<const VertexConstraint> constraints) {
  const Region& region = problem.deform.region;
  std::vector<std::uint8_t> is_free(static_cast<std::size_t>(problem.rest.rows()), region.whole ? 1 : 0);
  for (const Index v : region.vertices) is_free[v] = 1;
  for (const VertexConstraint& constraint : constraints)
    if (constraint.position) is_free[constraint.vertex] = 0;
  std::vector<Index> free(problem.triangles.data(), problem.triangles.data() + problem.triangles.size());
  std::erase_if(free, [&](Index v) { return !is_free[v]; });
  std::sort(free.begin(), free.end());
  free.erase(std::unique(free.begin(), free.end()), free.end());
  return free;
}

Solution solve_by_baseline(Baseline method, const DeformProblem& problem, const DeformSettings& settings,
                           StepReport& report, const Context& context) {
  const Region& region = problem.deform.region;
  if (!region.anchors.empty())
    throw Error(ErrorCode::input, fmt::format("the method '{}' knows no anchors", to_string(method)), "anchors",
                "Leave them out, or compare without this method.");
  Stopwatch watch;
  context.step("solve");
  const std::vector<VertexConstraint> constraints = joined_constraints(problem, context);
  BaselineOptions options;
  options.backend = settings.deformer.backend;
  Solution solution;
  solution.positions =
      deform_by(method, problem.rest, problem.triangles, region.vertices, constraints, options, context);
  report.seconds.solve = watch.lap();
  solution.free = free_vertices(problem, constraints);
  return solution;
}

// The solve of what `options` are for: the region itself, or a proxy of it.
Deformer make_deformer(const DeformProblem& problem, std::span<const VertexConstraint> constraints,
                       const DeformerOptions& options, const Context& context) {
  const Region& region = problem.deform.region;
  if (problem.deform.constraints.empty()) return {problem.rest, problem.triangles, region, options, context};
  return Deformer::with_constraints(problem.rest, problem.triangles, region.vertices, constraints,
                                    region.anchors, region.features, options, context);
}

ProxyDeformer make_deformer(const DeformProblem& problem, std::span<const VertexConstraint> constraints,
                            const ProxyOptions& options, const Context& context) {
  const Region& region = problem.deform.region;
  if (problem.deform.constraints.empty()) return {problem.rest, problem.triangles, region, options, context};
  return ProxyDeformer::with_constraints(problem.rest, problem.triangles, region.vertices, constraints,
                                         region.anchors, region.features, options, context);
}

const DeformerSummary& note_facts(const Deformer& deformer, StepReport&) { return deformer.summary(); }

const DeformerSummary& note_facts(const ProxyDeformer& deformer, StepReport& report) {
  const ProxySummary& summary = deformer.summary();
  report.proxy = ProxyFacts{summary.vertices, summary.deformer.free_vertices, summary.spacing};
  return summary.deformer;
}

// Factorises, solves and measures: by handles, or vertex by vertex where some are constrained by themselves.
template <class Options>
Solution solve_by(const Options& deformer_options, const DeformProblem& problem, const RunOptions& options,
                  StepReport& report, const Context& context) {
  const bool by_handles = problem.deform.constraints.empty();
  std::vector<VertexConstraint> constraints;
  Stopwatch watch;
  if (!by_handles) constraints = joined_constraints(problem, context);
  const auto deformer = make_deformer(problem, constraints, deformer_options, context);
  const DeformerSummary& summary = note_facts(deformer, report);
  report.seconds.analyse = summary.analyse_seconds;
  report.seconds.factorise = summary.factorise_seconds;
  report.seconds.assemble = std::max(0.0, watch.lap() - summary.analyse_seconds - summary.factorise_seconds);
  report.solver = summary.solver;

  context.step("solve");
  Solution solution;
  EvaluationReport& evaluation = report.evaluation.emplace();
  solution.positions = by_handles ? deformer.evaluate(problem.deform.poses, context, &evaluation)
                                  : deformer.evaluate(constraints, context, &evaluation);
  report.seconds.solve = watch.lap();

  context.step("measure");
  if (options.estimate_condition) report.condition_estimate = deformer.condition_estimate(context);
  solution.free.assign(deformer.free_vertices().begin(), deformer.free_vertices().end());
  report.counts.degenerate = summary.degenerate_vertices;
  report.seconds.measure = watch.lap();
  return solution;
}

// Those of the region whose position nothing tells.
Index count_free_vertices(const DeformProblem& problem) {
  const Region& region = problem.deform.region;
  const bool whole = region.whole || region.vertices.empty();
  std::vector<std::uint8_t> free(static_cast<std::size_t>(problem.rest.rows()), whole);
  if (!whole)
    for (const Index v : region.vertices) free[v] = 1;
  for (const Index v : region.fixed) free[v] = 0;
  for (const Handle& handle : region.handles)
    if (handle.constrain_position)
      for (const Index v : handle.vertices) free[v] = 0;
  for (const VertexConstraint& constraint : problem.deform.constraints)
    if (constraint.position) free[constraint.vertex] = 0;
  return static_cast<Index>(std::count(free.begin(), free.end(), 1));
}

Solution solve(const DeformProblem& problem, const DeformSettings& settings, const RunOptions& options,
               StepReport& report, const Context& context) {
  Index proxy = settings.proxy;
  const std::uint64_t memory = options.memory.value_or(available_memory());
  const Index free = count_free_vertices(problem);
  if (proxy == 0 && choose_path(free, settings.deformer, memory) == SolvePath::proxy) {
    proxy = proxy_vertices_for(settings.deformer, memory);
    report.notes.push_back(fmt::format(
        "a solve for {} free vertices does not fit the {} MB of memory there are: it was made on a proxy", free,
        memory / 1'000'000));
  }
  if (proxy == 0) return solve_by(settings.deformer, problem, options, report, context);
  return solve_by(ProxyOptions{settings.deformer, proxy}, problem, options, report, context);
}

std::vector<std::string> notes_of(const StepReport& report) {
  std::vector<std::string> notes;
  if (report.proxy && report.proxy->free_vertices < report.counts.free)
    notes.push_back(
        fmt::format("a proxy with {} free vertices was solved in the place of {}: an approximation, closer "
                    "with more of them",
                    report.proxy->free_vertices, report.counts.free));
  if (report.evaluation && report.evaluation->fell_back_to_linear)
    notes.emplace_back(
        "a handle mirrors or flattens what it holds, so there is no rotation to follow; maps were blended "
        "linearly");
  constexpr double settled_enough = 0.02;  // radians: about one degree
  if (report.evaluation && report.evaluation->last_rotation_change > settled_enough)
    notes.push_back(fmt::format(
        "the rotations had not settled after {} steps (they would have changed by another "
        "{:.1f}°); more 'iterations' or less of a turn helps",
        report.evaluation->iterations, report.evaluation->last_rotation_change * 180 / std::numbers::pi));
  return notes;
}

std::string weld_note(const Weld& weld) {
  return fmt::format(
      "{} boundary vertices were welded to others at their place for the solve; the result keeps them apart "
      "('weld': false lets such places open)",
      weld.copies);
}

double largest_displacement(const Points& rest, const Points& edited) {
  double largest = 0;
  for (Eigen::Index i = 0; i < rest.rows(); ++i)
    if (rest.row(i) != edited.row(i)) largest = std::max(largest, (edited.row(i) - rest.row(i)).norm());
  return largest;
}

Index count_handle_vertices(const Region& region) {
  return std::accumulate(
      region.handles.begin(), region.handles.end(), Index{0},
      [](Index sum, const Handle& h) { return sum + static_cast<Index>(h.vertices.size()); });
}

StepReport run_deform(const EditFile& edit, const DeformStep& step, const std::string& place, Scene& scene,
                      const RunOptions& options, const Context& context) {
  Stopwatch watch;
  StepReport report;
  report.mesh = step.mesh;
  report.result = step.result.empty() ? step.mesh : step.result;
  report.settings = step.settings;
  report.settings.deformer = effective_options(step.settings.deformer, options.overrides);
  report.settings.proxy = options.overrides.proxy.value_or(report.settings.proxy);
  report.method = options.overrides.method.value_or(report.settings.deformer.method);

  context.step("select");
  DeformSetup setup = set_up_deform(edit, step, place, scene, report.settings);
  DeformProblem& problem = setup.problem;
  const Weld& weld = setup.weld;
  Mesh& mesh = weld.empty() ? scene.mesh : setup.welded;
  const Triangles triangles = problem.triangles;
  report.seconds.select = watch.lap();

  report.counts.vertices = scene.mesh.vertex_count();
  report.counts.faces = scene.mesh.face_count();
  report.counts.fixed = static_cast<Index>(problem.deform.region.fixed.size());
  report.counts.handle =
      count_handle_vertices(problem.deform.region) + static_cast<Index>(problem.deform.constraints.size());
  problem = refine_boundary(std::move(problem), report.settings.refine_boundary, context);
  report.seconds.select += watch.lap();

  Solution solution;
  try {
    const auto* baseline = std::get_if<Baseline>(&report.method);
    solution = baseline ? solve_by_baseline(*baseline, problem, report.settings, report, context)
                        : solve(problem, report.settings, options, report, context);
  } catch (const Error& error) {
    if (error.code() == ErrorCode::cancelled) throw;
    throw error.within(place);
  }

  watch.lap();
  const Index count = scene.mesh.vertex_count();
  std::erase_if(solution.free, [&](Index v) { return v >= count; });
  const Points rest = std::exchange(mesh.positions, solution.positions.topRows(count));
  update_normals(mesh, rest);
  for (const Index v : solution.free) scene.was_free[v] = 1;
  if (!weld.empty()) {
    unweld(mesh, weld, scene.mesh);
    for (Index v = 0; v < count; ++v) scene.was_free[v] = scene.was_free[weld.of(v)];
  }
  report.counts.free = static_cast<Index>(solution.free.size());
  report.max_displacement = largest_displacement(rest, scene.mesh.positions);
  report.quality = measure_quality(rest, scene.mesh.positions, triangles, solution.free, {}, context);
  const std::vector<std::string> notes = notes_of(report);
  report.notes.insert(report.notes.end(), notes.begin(), notes.end());
  if (!weld.empty()) report.notes.push_back(weld_note(weld));
  report.seconds.measure += watch.lap();
  report.seconds.total = watch.seconds();
  return report;
}

void add_seconds(StageSeconds& sum, const StageSeconds& part) {
  sum.triage += part.triage;
  sum.select += part.select;
  sum.match += part.match;
  sum.assemble += part.assemble;
  sum.analyse += part.analyse;
  sum.factorise += part.factorise;
  sum.basis += part.basis;
  sum.solve += part.solve;
  sum.seam += part.seam;
  sum.measure += part.measure;
}

void sum_up(EditReport& report) {
  for (const StepReport& step : report.steps) {
    add_seconds(report.seconds, step.seconds);
    if (&step == &report.steps.front() || step.counts.free > report.counts.free) {
      report.counts = step.counts;
      report.solver = step.solver;
    }
    if (step.evaluation) {
      if (!report.evaluation) report.evaluation.emplace();
      EvaluationReport& largest = *report.evaluation;
      largest.residual = std::max(largest.residual, step.evaluation->residual);
      largest.max_transform_deviation =
          std::max(largest.max_transform_deviation, step.evaluation->max_transform_deviation);
    }
    if (step.condition_estimate)
      report.condition_estimate = std::max(report.condition_estimate.value_or(0), *step.condition_estimate);
  }
}

// The quality of what deform steps made of the result since its faces were what they are; of a single step it
// is known already.
void measure_result(EditReport& report, const Scene& scene, const Context& context) {
  Stopwatch watch;
  const bool same_faces = std::none_of(report.steps.begin(), report.steps.end(),
                                       [](const StepReport& step) { return step.merge || step.cut; });
  report.deformed = same_faces || std::any_of(scene.was_free.begin(), scene.was_free.end(),
                                              [](std::uint8_t free) { return free != 0; });
  if (!report.deformed) return;
  if (report.steps.size() == 1) {
    report.quality = report.steps.front().quality;
    report.max_displacement = report.steps.front().max_displacement;
  } else {
    std::vector<Index> free;
    for (Index v = 0; v < scene.mesh.vertex_count(); ++v)
      if (scene.was_free[v]) free.push_back(v);
    Mesh before;
    before.positions = scene.rest;
    before.faces = scene.mesh.faces;
    report.quality =
        measure_quality(scene.rest, scene.mesh.positions,
                        triangulate(before, {.skip_out_of_range = true}).triangles, free, {}, context);
    report.max_displacement = largest_displacement(scene.rest, scene.mesh.positions);
  }
  report.seconds.measure += watch.lap();
}

}  // namespace

Mesh load_input(const EditInput& input, const EditFile& edit, const Context& context) {
  const std::string place = fmt::format("{}: inputs.{}", edit.place, input.name);
  try {
    if (!input.sample.empty()) return make_sample(input.sample, input.resolution, context);
    const std::filesystem::path path = edit.base_folder / input.file;
    require_hash(input, path, place);
    return read_mesh(path, context);
  } catch (const Error& error) {
    if (error.code() == ErrorCode::cancelled || error.place().starts_with(place)) throw;
    throw error.within(place);
  }
}

DeformerOptions effective_options(DeformerOptions options, const SettingsOverrides& overrides) {
  OperatorOptions& operators = options.operators;
  if (overrides.method)
    if (const auto* method = std::get_if<DeformMethod>(&*overrides.method)) options.method = *method;
  options.stiffness = overrides.stiffness.value_or(options.stiffness);
  options.iterations = overrides.iterations.value_or(options.iterations);
  operators.weights = overrides.weights.value_or(operators.weights);
  operators.density = overrides.density.value_or(operators.density);
  operators.degenerate = overrides.degenerate.value_or(operators.degenerate);
  options.backend = overrides.backend.value_or(options.backend);
  return options;
}

DeformSetup set_up_deform(const EditFile& edit, const DeformStep& step, const std::string& place,
                          const Scene& scene, const DeformSettings& settings) {
  DeformSetup setup;
  const Finding* torn = scene.triage.find("duplicate-vertex");
  const bool welds = torn != nullptr && settings.weld && !scene.is_cut;
  if (welds) setup.weld = weld_at(scene.mesh, torn->indices);
  if (!setup.weld.empty()) setup.welded = welded(scene.mesh, setup.weld);
  const Mesh& mesh = setup.weld.empty() ? scene.mesh : setup.welded;
  {
    const SelectionContext selections(mesh, setup.weld);
    setup.problem.deform = resolve_deform(edit, step, selections, place, scene.produced);
    require_usable_within_reach(scene, setup.problem.deform.region, selections, reach_rings(settings));
  }
  setup.problem.rest = mesh.positions;
  setup.problem.triangles = triangulate(mesh, {.skip_out_of_range = true}).triangles;
  return setup;
}

StepReport run_step(const EditFile& edit, const EditStep& edit_step, const std::string& place,
                    std::map<std::string, Scene>& scenes, const RunOptions& options, const Context& context) {
  if (std::holds_alternative<MergeStep>(edit_step.action))
    return run_merge(edit, edit_step, place, scenes, options, context);
  if (std::holds_alternative<CutStep>(edit_step.action)) return run_cut(edit_step, place, scenes, context);
  const auto& step = std::get<DeformStep>(edit_step.action);
  const std::string& output = outcome_of(edit_step);
  if (output != step.mesh) scenes.insert_or_assign(output, scenes.at(step.mesh));
  return run_deform(edit, step, place, scenes.at(output), options, context);
}

Scene make_scene(Mesh mesh, std::string label, const Context& context) {
  Scene scene;
  scene.triage = triage(mesh, context);
  scene.rest = mesh.positions;
  scene.was_free.assign(static_cast<std::size_t>(mesh.vertex_count()), 0);
  scene.label = std::move(label);
  scene.mesh = std::move(mesh);
  return scene;
}

void carry_produced(const ProducedSets& from, const IndexMap& map, ProducedSets& to) {
  for (const auto& [step, sets] : from)
    for (const auto& [what, vertices] : sets) {
      std::vector<Index>& carried = to[step][what];
      carried.clear();
      for (const Index v : vertices)
        if (map.new_index[static_cast<std::size_t>(v)] >= 0)
          carried.push_back(map.new_index[static_cast<std::size_t>(v)]);
    }
}

LoadedInputs load_inputs(const EditFile& edit, const Context& context) {
  LoadedInputs inputs;
  for (const EditInput& input : edit.inputs) {
    Stopwatch watch;
    context.step("read");
    Mesh mesh = load_input(input, edit, context);
    inputs.read_seconds += watch.lap();
    context.step("check");
    Scene scene = make_scene(std::move(mesh), label_of(input), context);
    inputs.triage_seconds += watch.lap();
    inputs.reports.push_back(
        {input.name, scene.label, scene.mesh.vertex_count(), scene.mesh.face_count(), scene.triage});
    inputs.scenes.emplace(input.name, std::move(scene));
  }
  return inputs;
}

EditResult run_steps(const EditFile& edit, LoadedInputs inputs, const RunOptions& options,
                     const Context& context) {
  Stopwatch watch;
  EditResult result;
  EditReport& report = result.report;
  report.edit = edit.place;
  report.inputs = std::move(inputs.reports);
  report.seconds.read = inputs.read_seconds;
  report.seconds.triage = inputs.triage_seconds;
  std::map<std::string, Scene>& scenes = inputs.scenes;

  std::string output;
  for (std::size_t i = 0; i < edit.steps.size(); ++i) {
    const std::string place = fmt::format("{}: steps[{}]", edit.place, i);
    output = outcome_of(edit.steps[i]);
    report.steps.push_back(run_step(edit, edit.steps[i], place, scenes, options, context));
    report.steps.back().name = edit.steps[i].name;
  }
  Scene& scene = scenes.at(edit.output.empty() ? output : edit.output);
  sum_up(report);
  measure_result(report, scene, context);
  for (const std::string& name : options.keep) result.kept.insert_or_assign(name, scenes.at(name).mesh);
  result.mesh = std::move(scene.mesh);
  result.rest = std::move(scene.rest);
  report.seconds.total = inputs.read_seconds + inputs.triage_seconds + watch.seconds();
  return result;
}

EditResult run_edit(const EditFile& edit, const RunOptions& options, const Context& context) {
  const std::vector<std::string> names = mesh_names(edit);
  for (const std::string& wanted : options.keep)
    if (std::find(names.begin(), names.end(), wanted) == names.end())
      throw Error(ErrorCode::usage, fmt::format("the edit has no mesh named '{}'", wanted), edit.place,
                  fmt::format("It has '{}'.", fmt::join(names, "', '")));
  return run_steps(edit, load_inputs(edit, context), options, context);
}

}  // namespace meshgraft
