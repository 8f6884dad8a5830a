// The deform step of an edit.
#include <algorithm>
#include <numbers>
#include <numeric>
#include <utility>

#include <meshgraft/core/error.h>
#include <meshgraft/deform/deformer.h>
#include <meshgraft/deform/quality.h>
#include <meshgraft/deform/quick_frames.h>
#include <meshgraft/mesh/normals.h>
#include <meshgraft/mesh/topology.h>
#include <meshgraft/script/run_edit.h>

#include "baselines/baselines.h"
#include "core/memory.h"
#include "core/stopwatch.h"
#include "deform/measure/quality_of_surface.h"
#include "deform/setup/memory_estimate.h"
#include "mesh/simple_surface.h"
#include "mesh/weld.h"
#include "refine_boundary.h"
#include "resolve_deform.h"
#include "run_steps.h"
#include "script/facts.h"

namespace meshgraft {

namespace {

// Returns how many rings around the region the solve uses: stencils of stencils, and their normals.
int reach_rings(const DeformSettings& settings) { return settings.deformer.operators.laplacian_order + 4; }

void require_sound_within_reach(const MeshState& state, const Region& region, const SelectionMesh& selections,
                                int reach) {
  std::vector<Index> vertices = region.vertices;
  if (region.whole) {
    vertices.resize(selections.mesh.vertex_count());
    std::iota(vertices.begin(), vertices.end(), Index{0});
  }
  vertices = grow_rings(vertices, reach, selections.rings);
  // Vertices without a face have no equations.
  std::erase_if(vertices, [&](Index v) { return selections.components[v] < 0; });
  if (!vertices.empty())
    require_sound(state.diagnostics, selections.mesh, {.vertices = vertices, .name = state.label});
}

// Returns all constraints of a step per vertex: fixed vertices, handles, and constraints of single vertices.
std::vector<VertexConstraint> joined_constraints(const ResolvedProblem& problem, const Context& context) {
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
    const auto held = handle_constraints(region.handles[h], poses[h], {problem.rest, normals});
    constraints.insert(constraints.end(), held.begin(), held.end());
  }
  constraints.insert(constraints.end(), problem.deform.constraints.begin(), problem.deform.constraints.end());
  return constraints;
}

// Returns the problem with all its constraints per vertex, in place of fixed vertices and handles.
DeformProblem problem_of_vertices(const ResolvedProblem& problem, std::vector<VertexConstraint> constraints) {
  const Region& region = problem.deform.region;
  return {problem.rest,
          problem.triangles,
          {.vertices = region.vertices,
           .whole = region.vertices.empty(),
           .anchors = region.anchors,
           .features = region.features},
          std::move(constraints)};
}

struct Solution {
  Points positions;  // of the problem's vertices
  std::vector<Index> free;
};

// Returns the vertices that a published method solves for, like `Deformer::free_vertices`.
std::vector<Index> free_vertices(const ResolvedProblem& problem,
                                 std::span<const VertexConstraint> constraints) {
  const Region& region = problem.deform.region;
  Flags is_free(problem.rest.rows(), region.whole ? 1 : 0);
  for (const Index v : region.vertices) is_free[v] = 1;
  for (const VertexConstraint& constraint : constraints)
    if (constraint.position) is_free[constraint.vertex] = 0;
  std::vector<Index> free(problem.triangles.data(), problem.triangles.data() + problem.triangles.size());
  std::erase_if(free, [&](Index v) { return !is_free[v]; });
  std::sort(free.begin(), free.end());
  free.erase(std::unique(free.begin(), free.end()), free.end());
  return free;
}

Solution solve_by_baseline(Baseline method, const ResolvedProblem& problem, const DeformSettings& settings,
                           StepReport& report, const Context& context) {
  const Region& region = problem.deform.region;
  if (!region.anchors.empty()) throw Error(facts::script::NoAnchors{.method = to_string(method)}, "anchors");
  if (!region.features.empty()) throw Error(facts::script::NoFeatures{.method = to_string(method)}, "features");
  Stopwatch watch;
  context.step("solve");
  const std::vector<VertexConstraint> constraints = joined_constraints(problem, context);
  BaselineOptions options;
  options.backend = settings.deformer.backend;
  Solution solution;
  solution.positions = deform_by(method, problem_of_vertices(problem, constraints), options, context);
  report.seconds.solve = watch.lap();
  solution.free = free_vertices(problem, constraints);
  return solution;
}

// Makes the deformer that `options` ask for: of the region itself, or of a proxy.
Deformer make_deformer(const ResolvedProblem& problem, std::vector<VertexConstraint> constraints,
                       const DeformerOptions& options, const Context& context) {
  const Region& region = problem.deform.region;
  if (problem.deform.constraints.empty()) return {problem.rest, problem.triangles, region, options, context};
  return Deformer(problem_of_vertices(problem, std::move(constraints)), options, context);
}

ProxyDeformer make_deformer(const ResolvedProblem& problem, std::vector<VertexConstraint> constraints,
                            const ProxyOptions& options, const Context& context) {
  const Region& region = problem.deform.region;
  if (problem.deform.constraints.empty()) return {problem.rest, problem.triangles, region, options, context};
  return ProxyDeformer(problem_of_vertices(problem, std::move(constraints)), options, context);
}

const DeformerSummary& note_facts(const Deformer& deformer, StepReport&) { return deformer.summary(); }

const DeformerSummary& note_facts(const ProxyDeformer& deformer, StepReport& report) {
  const ProxySummary& summary = deformer.summary();
  report.proxy = ProxyReport{summary.vertices, summary.deformer.free_vertices, summary.spacing};
  return summary.deformer;
}

// Factorises, solves and measures. Solves by handles, or by vertex constraints where the step has constraints
// of single vertices.
template <class Options>
Solution solve_by(const Options& deformer_options, const ResolvedProblem& problem, const RunOptions& options,
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

// Counts the vertices of the region without a prescribed position.
Index count_free_vertices(const ResolvedProblem& problem) {
  const Region& region = problem.deform.region;
  const bool whole = region.whole || region.vertices.empty();
  Flags free(problem.rest.rows(), whole);
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

Solution solve(const ResolvedProblem& problem, const DeformSettings& settings, const RunOptions& options,
               StepReport& report, const Context& context) {
  Index proxy = settings.proxy;
  const std::uint64_t memory = options.memory.value_or(available_memory());
  const Index free = count_free_vertices(problem);
  if (proxy == 0 && choose_path(free, settings.deformer, memory) == SolvePath::proxy) {
    proxy = proxy_vertices_for(settings.deformer, memory);
    report.notes.push_back(facts::script::ProxyForMemory{.free = free, .megabytes = memory / 1'000'000});
  }
  if (proxy == 0) return solve_by(settings.deformer, problem, options, report, context);
  return solve_by(ProxyOptions{settings.deformer, proxy}, problem, options, report, context);
}

/// Returns the smallest scale by which a handle's pose or a constraint shrinks what it holds, at most 1.
double smallest_scale(const ResolvedDeform& deform) {
  double smallest = 1;
  const auto include = [&](const Eigen::Matrix3d& map) {
    smallest = std::min(smallest, map.jacobiSvd().singularValues()[2]);
  };
  for (const HandlePose& pose : deform.poses) include(pose.transform.linear());
  for (const VertexConstraint& constraint : deform.constraints)
    if (constraint.transform) include(*constraint.transform);
  return smallest;
}

std::vector<Note> notes_of(const StepReport& report, double smallest_scale) {
  std::vector<Note> notes;
  if (report.proxy && report.proxy->free_vertices < report.counts.free)
    notes.push_back(
        facts::script::ProxySolved{.proxy = report.proxy->free_vertices, .free = report.counts.free});
  if (report.evaluation && report.evaluation->fell_back_to_linear) notes.push_back(facts::script::NoRotation{});
  constexpr double most_stretch = 1.25;  // chosen
  if (report.evaluation && report.evaluation->position_stretch > most_stretch)
    notes.push_back(facts::script::PositionsStretch{.ratio = report.evaluation->position_stretch});
  constexpr double settled_enough = 0.005;  // radians: 0.3 degrees
  if (report.evaluation && report.evaluation->last_rotation_change > settled_enough)
    notes.push_back(facts::script::NotSettled{
        .iterations = report.evaluation->iterations,
        .change_deg = report.evaluation->last_rotation_change * 180 / std::numbers::pi});
  if (report.evaluation && !report.evaluation->shell_settled)
    notes.push_back(facts::script::ShellNotSettled{.steps = report.evaluation->shell_steps});
  constexpr double pinched = 0.5;  // chosen, × the handles' scale
  if (report.quality.width_min < pinched * smallest_scale)
    notes.push_back(facts::script::Pinched{.vertex = report.quality.narrowest_vertex,
                                           .percent = 100 * report.quality.width_min});
  return notes;
}

Index count_handle_vertices(const Region& region) {
  return std::accumulate(
      region.handles.begin(), region.handles.end(), Index{0},
      [](Index sum, const Handle& h) { return sum + static_cast<Index>(h.vertices.size()); });
}

// Writes a solution into the state and returns the previous positions of the problem's vertices.
Points keep_solution(Solution& solution, DeformSetup& setup, MeshState& state) {
  const Weld& weld = setup.weld;
  Mesh& mesh = weld.empty() ? state.mesh : setup.welded;
  const Index count = state.mesh.vertex_count();
  std::erase_if(solution.free, [&](Index v) { return v >= count; });
  if (solution.positions.rows() > count) solution.positions.conservativeResize(count, 3);
  Points rest = std::exchange(mesh.positions, std::move(solution.positions));
  update_normals(mesh, rest);
  for (const Index v : solution.free) state.was_free[v] = 1;
  if (!weld.empty()) {
    unweld(mesh, weld, state.mesh);
    for (Index v = 0; v < count; ++v) state.was_free[v] = state.was_free[weld.of(v)];
  }
  return rest;
}

}  // namespace

void apply_solution(const EditFile& edit, const EditStep& edit_step, const Location& location,
                    std::map<std::string, MeshState>& states, const Points& positions, const Context& context) {
  const auto& step = std::get<DeformStep>(edit_step.action);
  MeshState& state = state_for_outcome(edit_step, states);
  DeformSetup setup = set_up_deform(edit, step, location, state, step.settings);
  Solution solution{positions, free_vertices(setup.problem, joined_constraints(setup.problem, context))};
  keep_solution(solution, setup, state);
}

double largest_displacement(const Points& rest, const Points& edited) {
  double largest = 0;
  for (Eigen::Index i = 0; i < rest.rows(); ++i)
    if (rest.row(i) != edited.row(i)) largest = std::max(largest, (edited.row(i) - rest.row(i)).norm());
  return largest;
}

namespace {

// Returns options with the overrides in their place, the preset before the others.
DeformerOptions effective_options(DeformerOptions options, const SettingsOverrides& overrides) {
  if (overrides.preset) {
    const SolverBackend backend = options.backend;
    options = DeformerOptions::as_published();
    options.backend = backend;
  }
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

}  // namespace

DeformSettings effective_settings(DeformSettings settings, const SettingsOverrides& overrides) {
  settings.deformer = effective_options(settings.deformer, overrides);
  if (overrides.preset) {
    settings.preset = overrides.preset;
    settings.proxy = 0;
    settings.refine_boundary = settings.refine_boundary.value_or(0);
  }
  settings.proxy = overrides.proxy.value_or(settings.proxy);
  return settings;
}

MergeSettings effective_settings(MergeSettings settings, const SettingsOverrides& overrides) {
  settings.deformer = effective_options(settings.deformer, overrides);
  if (settings.deformer.method == DeformMethod::shell) settings.deformer.method = DeformMethod::corotational;
  if (overrides.preset) {
    settings.preset = overrides.preset;
    settings.seam = MergeOptions::as_published().seam;
  }
  return settings;
}

namespace {

// Returns the triangles of a mesh. Those of a simple surface are its faces.
Triangles triangles_of(const Mesh& mesh, bool is_simple_surface) {
  if (is_simple_surface) return Eigen::Map<const Triangles>(mesh.faces.corners().data(), mesh.face_count(), 3);
  return triangulate(mesh, {.skip_out_of_range = true}).triangles;
}

}  // namespace

DeformSetup set_up_deform(const EditFile& edit, const DeformStep& step, const Location& location,
                          const MeshState& state, const DeformSettings& settings) {
  DeformSetup setup;
  const Finding* torn = state.diagnostics.find(FindingKind::duplicate_vertex);
  const bool welds = torn != nullptr && settings.weld && !state.is_cut;
  if (welds) setup.weld = weld_at(state.mesh, torn->indices);
  if (!setup.weld.empty()) setup.welded = welded(state.mesh, setup.weld);
  const Mesh& mesh = setup.weld.empty() ? state.mesh : setup.welded;
  {
    const SelectionMesh selections = setup.weld.empty() && state.surface
                                         ? SelectionMesh(mesh, connectivity(mesh, *state.surface))
                                         : SelectionMesh(mesh, setup.weld);
    setup.problem.deform = resolve_deform(edit, step, selections, location, state.produced);
    require_sound_within_reach(state, setup.problem.deform.region, selections, reach_rings(settings));
  }
  setup.problem.rest = mesh.positions;
  setup.problem.triangles = triangles_of(mesh, setup.weld.empty() && state.surface);
  return setup;
}

namespace {

// Notes curves whose redrawn course is taken for half a turn.
void note_mirrored_curves(const ResolvedProblem& problem, std::vector<Note>& notes, const Context& context) {
  const std::vector<HandlePose>& poses = problem.deform.poses;
  if (std::ranges::none_of(poses, [](const HandlePose& pose) { return pose.curve.has_value(); })) return;
  const auto n = static_cast<Index>(problem.rest.rows());
  const Points normals =
      vertex_normals(problem.rest, problem.triangles, vertex_triangles(n, problem.triangles, context), context);
  for (std::size_t h = 0; h < poses.size(); ++h) {
    const Handle& handle = problem.deform.region.handles[h];
    if (poses[h].curve && is_mirror_image(handle, {problem.rest, normals}, *poses[h].curve))
      notes.push_back(facts::script::MirroredCurve{.handle = handle.name});
  }
}

// Returns notes on overrides that the method does not use.
std::vector<Note> unused_overrides(const Method& method, const SettingsOverrides& overrides) {
  std::vector<Note> notes;
  const auto note = [&](std::string setting) {
    notes.push_back(facts::script::SettingWithoutUse{.method = std::string(to_string(method)),
                                                     .setting = std::move(setting)});
  };
  const auto* own = std::get_if<DeformMethod>(&method);
  if (overrides.stiffness && (!own || *own == DeformMethod::ft05)) note("stiffness");
  if (overrides.iterations && (!own || !is_corotational(*own))) note("iterations");
  return notes;
}

}  // namespace

StepReport run_deform(const EditFile& edit, const DeformStep& step, const Location& location, MeshState& state,
                      const RunOptions& options, const Context& context) {
  Stopwatch watch;
  StepReport report;
  report.mesh = step.mesh;
  report.result = step.result.empty() ? step.mesh : step.result;
  report.settings = effective_settings(step.settings, options.overrides);
  report.method = options.overrides.method.value_or(report.settings.deformer.method);

  context.step("select");
  DeformSetup setup = set_up_deform(edit, step, location, state, report.settings);
  ResolvedProblem& problem = setup.problem;
  const Weld& weld = setup.weld;
  const bool has_surface = weld.empty() && state.surface;
  report.seconds.select = watch.lap();

  report.symmetry = problem.deform.symmetry;
  for (const Handle& handle : problem.deform.region.handles) report.handles.push_back(handle.name);
  report.notes = problem.deform.notes;
  for (const Note& note : unused_overrides(report.method, options.overrides)) report.notes.push_back(note);
  if (report.symmetry) {
    const ResolvedDeform& deform = problem.deform;
    const auto notes = pose_notes(*report.symmetry, deform.region.handles, deform.poses, problem.rest);
    report.notes.insert(report.notes.end(), notes.begin(), notes.end());
  }
  note_mirrored_curves(problem, report.notes, context);
  report.counts.vertices = state.mesh.vertex_count();
  report.counts.faces = state.mesh.face_count();
  report.counts.fixed = static_cast<Index>(problem.deform.region.fixed.size());
  report.counts.handle =
      count_handle_vertices(problem.deform.region) + static_cast<Index>(problem.deform.constraints.size());
  const bool is_own = std::holds_alternative<DeformMethod>(report.method);
  std::optional<int> levels = report.settings.refine_boundary;
  if (!is_own || report.settings.proxy > 0) levels = levels.value_or(0);
  problem = refine_boundary(std::move(problem), levels, context);
  report.refined_vertices = static_cast<Index>(problem.rest.rows()) - state.mesh.vertex_count();
  Triangles own;  // before refinement
  if (report.refined_vertices > 0) own = triangles_of(weld.empty() ? state.mesh : setup.welded, has_surface);
  const Triangles& triangles = report.refined_vertices > 0 ? own : problem.triangles;
  report.seconds.select += watch.lap();

  Solution solution;
  try {
    const auto* baseline = std::get_if<Baseline>(&report.method);
    solution = baseline ? solve_by_baseline(*baseline, problem, report.settings, report, context)
                        : solve(problem, report.settings, options, report, context);
  } catch (const Error& error) {
    if (error.code() == ErrorCode::cancelled) throw;
    const Index added = report.refined_vertices;
    const facts::script::RefinedForSolve refined{.added = added, .first = state.mesh.vertex_count()};
    throw(added > 0 ? error.with(refined) : error).within(location);
  }

  watch.lap();
  const Points rest = keep_solution(solution, setup, state);
  report.counts.free = static_cast<Index>(solution.free.size());
  report.max_displacement = largest_displacement(rest, state.mesh.positions);
  const EditedMesh edited{rest, state.mesh.positions, triangles, solution.free};
  report.quality =
      has_surface ? measure_quality(edited, *state.surface, {}, context) : measure_quality(edited, {}, context);
  const std::vector<Note> notes = notes_of(report, smallest_scale(problem.deform));
  report.notes.insert(report.notes.end(), notes.begin(), notes.end());
  if (!weld.empty()) report.notes.push_back(facts::script::Welded{.vertices = weld.copies});
  report.seconds.measure += watch.lap();
  report.seconds.total = watch.seconds();
  return report;
}

}  // namespace meshgraft
