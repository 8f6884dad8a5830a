#include <meshgraft/script/run_edit.h>

#include <algorithm>
#include <map>
#include <utility>

#include <fmt/format.h>

#include <meshgraft/core/error.h>
#include <meshgraft/deform/quality.h>
#include <meshgraft/io/mesh_io.h>
#include <meshgraft/mesh/topology.h>
#include <meshgraft/samples/samples.h>

#include "core/stopwatch.h"
#include "io/file.h"
#include "mesh/checked_surface.h"
#include "run_steps.h"
#include "script/facts.h"
#include "sha256.h"

namespace meshgraft {

namespace {

void require_hash(const EditInput& input, const std::filesystem::path& path, const Location& location) {
  if (!input.sha256) return;
  const std::string found = sha256(read_file(path));
  if (found != *input.sha256)
    throw Error(facts::script::WrongSha256{.file = path, .found = found, .expected = *input.sha256},
                location / "sha256");
}

std::string label_of(const EditInput& input) {
  if (input.sample.empty()) return input.file;
  return input.resolution == 0 ? "sample " + input.sample
                               : fmt::format("sample {} at resolution {}", input.sample, input.resolution);
}

void add_seconds(StageSeconds& sum, const StageSeconds& part) {
  sum.check += part.check;
  sum.select += part.select;
  sum.match += part.match;
  sum.assemble += part.assemble;
  sum.analyse += part.analyse;
  sum.factorise += part.factorise;
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

// Measures the effect of all deform steps since the faces last changed. For a single step the quality is
// known already.
void measure_result(EditReport& report, const MeshState& state, const Context& context) {
  Stopwatch watch;
  const bool same_faces = std::ranges::none_of(report.steps, &StepReport::replaces_mesh);
  const auto shapes = [](const StepReport& step) { return step.is_deform() || step.sculpt; };
  report.deformed = std::ranges::any_of(report.steps, shapes) &&
                    (same_faces || std::any_of(state.was_free.begin(), state.was_free.end(),
                                               [](std::uint8_t free) { return free != 0; }));
  if (!report.deformed) return;
  if (report.steps.size() == 1 && report.steps.front().is_deform()) {
    report.quality = report.steps.front().quality;
    report.max_displacement = report.steps.front().max_displacement;
  } else {
    std::vector<Index> free;
    for (Index v = 0; v < state.mesh.vertex_count(); ++v)
      if (state.was_free[v]) free.push_back(v);
    Mesh before;
    before.positions = state.rest;
    before.faces = state.mesh.faces;
    report.quality = measure_quality(
        {state.rest, state.mesh.positions, triangulate(before, {.skip_out_of_range = true}).triangles, free},
        {}, context);
    report.max_displacement = largest_displacement(state.rest, state.mesh.positions);
  }
  report.seconds.measure += watch.lap();
}

}  // namespace

Mesh load_input(const EditInput& input, const EditFile& edit, const Context& context) {
  const Location location = Location::file(edit.location) / "inputs" / Location::field(input.name);
  try {
    if (!input.sample.empty()) return make_sample(input.sample, input.resolution, context);
    const std::filesystem::path path = edit.base_folder / input.file;
    require_hash(input, path, location);
    return read_mesh(path, context);
  } catch (const Error& error) {
    if (error.code() == ErrorCode::cancelled || error.location().starts_with(location)) throw;
    throw error.within(location);
  }
}

StepReport run_step(const EditFile& edit, const EditStep& edit_step, const Location& location,
                    std::map<std::string, MeshState>& states, const RunOptions& options,
                    const Context& context) {
  if (std::holds_alternative<MergeStep>(edit_step.action))
    return run_merge(edit, edit_step, location, states, options, context);
  if (std::holds_alternative<CutStep>(edit_step.action)) return run_cut(edit_step, location, states, context);
  if (std::holds_alternative<RepairStep>(edit_step.action))
    return run_repair(edit_step, location, states, context);
  if (std::holds_alternative<SculptStep>(edit_step.action))
    return run_sculpt(edit, edit_step, location, states, context);
  if (std::holds_alternative<TransformStep>(edit_step.action))
    return run_transform(edit_step, location, states, context);
  return run_deform(edit, std::get<DeformStep>(edit_step.action), location,
                    state_for_outcome(edit_step, states), options, context);
}

MeshState& state_for_outcome(const EditStep& step, std::map<std::string, MeshState>& states) {
  const std::string& output = outcome_of(step);
  if (output != mesh_of(step)) states.insert_or_assign(output, states.at(mesh_of(step)));
  return states.at(output);
}

void check_state(MeshState& state, const Context& context) {
  CheckedSurface checked = check_surface(state.mesh, context);
  state.diagnostics = std::move(checked.diagnostics);
  state.surface = std::move(checked.surface);
}

MeshState make_mesh_state(Mesh mesh, std::string label, const Context& context) {
  MeshState state;
  state.mesh = std::move(mesh);
  check_state(state, context);
  state.rest = state.mesh.positions;
  state.was_free.assign(state.mesh.vertex_count(), 0);
  state.label = std::move(label);
  return state;
}

MeshState make_input_state(const EditInput& input, Mesh mesh, std::string label, const Context& context) {
  MeshState state = make_mesh_state(std::move(mesh), std::move(label), context);
  if (input.orientation) state.orientations = {{*input.orientation}};
  return state;
}

void carry_produced(const ProducedSets& from, const IndexMap& map, ProducedSets& to) {
  for (const auto& [step, sets] : from)
    for (const auto& [what, vertices] : sets) {
      std::vector<Index>& carried = to[step][what];
      carried.clear();
      for (const Index v : vertices)
        if (map.new_index[v] >= 0) carried.push_back(map.new_index[v]);
    }
}

LoadedInputs load_inputs(const EditFile& edit, const Context& context) {
  LoadedInputs inputs;
  for (const EditInput& input : edit.inputs) {
    Stopwatch watch;
    context.step("read");
    Mesh mesh = load_input(input, edit, context);
    for (const Note& note : notes_on_files(mesh)) inputs.notes.push_back(note);
    inputs.read_seconds += watch.lap();
    context.step("check");
    MeshState state = make_input_state(input, std::move(mesh), label_of(input), context);
    inputs.check_seconds += watch.lap();
    inputs.reports.push_back(
        {input.name, state.label, state.mesh.vertex_count(), state.mesh.face_count(), state.diagnostics});
    inputs.states.emplace(input.name, std::move(state));
  }
  return inputs;
}

// Returns whether a preset replaces the settings of every step, and nothing replaces those of the preset.
bool has_preset_alone(const SettingsOverrides& overrides) {
  return overrides.preset && !overrides.method && !overrides.stiffness && !overrides.iterations &&
         !overrides.weights && !overrides.density && !overrides.degenerate && !overrides.proxy &&
         !overrides.shape;
}

EditResult run_steps(const EditFile& edit, LoadedInputs inputs, const RunOptions& options,
                     const Context& context) {
  Stopwatch watch;
  EditResult result;
  EditReport& report = result.report;
  report.edit = edit.location;
  for (const Note& note : edit.notes)  // results of FT05 as written never change
    if (!has_preset_alone(options.overrides) || note.id() != facts::script::OtherMethods::id)
      report.notes.push_back(note);
  report.notes.insert(report.notes.end(), inputs.notes.begin(), inputs.notes.end());
  report.inputs = std::move(inputs.reports);
  report.seconds.read = inputs.read_seconds;
  report.seconds.check = inputs.check_seconds;
  std::map<std::string, MeshState>& states = inputs.states;

  std::string output;
  for (std::size_t i = 0; i < edit.steps.size(); ++i) {
    const Location location = (Location::file(edit.location) / "steps")[i];
    output = outcome_of(edit.steps[i]);
    report.steps.push_back(run_step(edit, edit.steps[i], location, states, options, context));
    report.steps.back().name = edit.steps[i].name;
  }
  MeshState& state = states.at(edit.output.empty() ? output : edit.output);
  sum_up(report);
  measure_result(report, state, context);
  for (const std::string& name : options.keep) result.kept.insert_or_assign(name, states.at(name).mesh);
  result.mesh = std::move(state.mesh);
  result.rest = std::move(state.rest);
  report.seconds.total = inputs.read_seconds + inputs.check_seconds + watch.seconds();
  return result;
}

void require_kept(const EditFile& edit, const RunOptions& options) {
  const std::vector<std::string> names = mesh_names(edit);
  for (const std::string& wanted : options.keep)
    if (std::find(names.begin(), names.end(), wanted) == names.end())
      throw Error(facts::script::NoMeshToKeep{.name = wanted, .known = names}, Location::file(edit.location));
}

EditResult run_edit(const EditFile& edit, const RunOptions& options, const Context& context) {
  require_kept(edit, options);
  return run_steps(edit, load_inputs(edit, context), options, context);
}

}  // namespace meshgraft
