#include <utility>

#include <meshgraft/core/error.h>
#include <meshgraft/mesh/repair.h>

#include "core/stopwatch.h"
#include "run_steps.h"
#include "script/facts.h"

namespace meshgraft {

StepReport run_repair(const EditStep& edit_step, const Location& location,
                      std::map<std::string, MeshState>& states, const Context& context) {
  const auto& step = std::get<RepairStep>(edit_step.action);
  Stopwatch watch;
  MeshState& state = state_for_outcome(edit_step, states);
  StepReport report;
  report.mesh = step.mesh;
  report.result = outcome_of(edit_step);
  RepairResult result;
  try {
    result = repair(state.mesh, step.options, context);
  } catch (const Error& error) {
    if (error.code() == ErrorCode::cancelled) throw;
    throw error.within(location);
  }
  if (result.mesh.face_count() == 0) throw Error(facts::script::NoFacesLeft{}, location);
  report.seconds.solve = watch.lap();
  if (result.changed()) {
    MeshState repaired = make_mesh_state(std::move(result.mesh), state.label, context);
    carry_produced(state.produced, result.vertex, repaired.produced);
    repaired.is_cut = state.is_cut;
    repaired.orientations = std::move(state.orientations);
    state = std::move(repaired);
  }
  report.counts.vertices = state.mesh.vertex_count();
  report.counts.faces = state.mesh.face_count();
  report.notes = std::move(result.notes);
  report.repair = RepairOutcome{step.options, std::move(result.changes), std::move(result.vertex)};
  report.seconds.check = watch.lap();
  report.seconds.total = watch.seconds();
  return report;
}

}  // namespace meshgraft
