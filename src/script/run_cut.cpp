#include <algorithm>

#include <fmt/format.h>

#include <meshgraft/core/error.h>
#include <meshgraft/mesh/cut.h>
#include <meshgraft/mesh/orientation.h>
#include <meshgraft/mesh/topology.h>

#include "core/stopwatch.h"
#include "mesh/sound_mesh.h"
#include "pin_field.h"
#include "run_steps.h"

namespace meshgraft {

namespace {

CutResult cut(const Mesh& mesh, const CutStep& step, const Context& context) {
  if (const auto* plane = std::get_if<Plane>(&step.along))
    return cut_by_plane(mesh, *plane, step.options, context);
  return cut_along_loop(mesh, std::get<std::vector<Index>>(step.along), step.options, context);
}

// Returns where an error of the cut is in its step, whose `pins` are options of the cut.
Location location_in_step(const Location& location) {
  const auto field = pin_field(location);
  return field ? Location("pins") / Location::field(*field) : location;
}

std::vector<Index> vertices_beside(const CutResult& result, int side) {
  std::vector<Index> vertices;
  for (Index f = 0; f < result.mesh.face_count(); ++f)
    if (result.face_side[f] == side)
      vertices.insert(vertices.end(), result.mesh.faces[f].begin(), result.mesh.faces[f].end());
  std::sort(vertices.begin(), vertices.end());
  vertices.erase(std::unique(vertices.begin(), vertices.end()), vertices.end());
  return vertices;
}

// Returns the named sets of a cut: "loop" where there is one loop, "loop 0" and so on always, "above" and
// "below".
std::map<std::string, std::vector<Index>> sets_of(const CutResult& result) {
  std::map<std::string, std::vector<Index>> sets;
  for (std::size_t k = 0; k < result.loops.size(); ++k) sets[fmt::format("loop {}", k)] = result.loops[k];
  if (result.loops.size() == 1) sets["loop"] = result.loops.front();
  sets["above"] = vertices_beside(result, 1);
  sets["below"] = vertices_beside(result, -1);
  return sets;
}

}  // namespace

StepReport run_cut(const EditStep& edit_step, const Location& location,
                   std::map<std::string, MeshState>& states, const Context& context) {
  const auto& step = std::get<CutStep>(edit_step.action);
  Stopwatch watch;
  const MeshState& state = states.at(step.mesh);
  const SoundMesh sound(state.mesh, state.diagnostics, state.label);
  StepReport report;
  report.mesh = step.mesh;
  report.result = outcome_of(edit_step);

  context.step("cut");
  CutResult result;
  try {
    if (const auto* loop = std::get_if<std::vector<Index>>(&step.along)) sound.require_beyond(*loop);
    result = cut(sound.mesh(), step, context);
    sound.require_beyond(vertices_at_cut(result));
    sound.put_back(result.vertex, result.mesh);
    if (const auto note = sound.note()) report.notes.push_back(*note);
  } catch (const Error& error) {
    if (error.code() == ErrorCode::cancelled) throw;
    throw sound.explained(error).at(location / location_in_step(error.location()));
  }
  report.notes.insert(report.notes.end(), result.notes.begin(), result.notes.end());
  report.seconds.solve = watch.lap();
  ProducedSets produced;
  carry_produced(state.produced, result.vertex, produced);
  if (!edit_step.name.empty()) produced[edit_step.name] = sets_of(result);
  report.cut = CutOutcome{step.options, std::move(result.loops), std::move(result.vertex),
                          summarise_topology(result.mesh), std::move(result.pins)};
  report.counts.vertices = result.mesh.vertex_count();
  report.counts.faces = result.mesh.face_count();

  MeshState opened = make_mesh_state(std::move(result.mesh), state.label + ", cut", context);
  opened.produced = std::move(produced);
  opened.is_cut = state.is_cut || step.options.cap == CutCap::open;
  opened.orientations = state.orientations.empty() ? guess_orientations(state.mesh) : state.orientations;
  states.insert_or_assign(report.result, std::move(opened));
  report.seconds.check = watch.lap();
  report.seconds.total = watch.seconds();
  return report;
}

}  // namespace meshgraft
