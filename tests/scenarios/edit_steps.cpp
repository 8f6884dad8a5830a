#include "edit_steps.h"

#include <algorithm>
#include <variant>

#include "merge/pose_source.h"
#include "script/merge_sides.h"
#include "support/paths.h"

namespace meshgraft::test {
namespace {

bool is_of_kind(const EditStep& step, StepKind kind) {
  if (kind == StepKind::deform) return std::holds_alternative<DeformStep>(step.action);
  const auto* merge = std::get_if<MergeStep>(&step.action);
  return merge != nullptr && (kind == StepKind::merge || !merge->at);
}

bool has_step(const EditFile& edit, StepKind kind) {
  return std::any_of(edit.steps.begin(), edit.steps.end(),
                     [&](const EditStep& step) { return is_of_kind(step, kind); });
}

using EditFiles = std::map<std::filesystem::path, EditFile>;

/// Returns the edit files of a folder. Reads them once, because every instantiation of a test asks for them.
const EditFiles& edit_files_in(const std::filesystem::path& folder) {
  static std::map<std::filesystem::path, EditFiles> known;
  const auto [at, is_new] = known.try_emplace(folder);
  if (!is_new || !std::filesystem::is_directory(folder)) return at->second;
  for (const auto& entry : std::filesystem::directory_iterator(folder))
    if (entry.path().extension() == ".json") at->second.emplace(entry.path(), read_edit_file(entry.path()));
  return at->second;
}

std::vector<Scenario> scenarios_in(const std::filesystem::path& folder, StepKind kind) {
  std::vector<Scenario> found;
  for (const auto& [path, edit] : edit_files_in(folder))
    if (has_step(edit, kind)) found.push_back({path.stem().string(), path});
  std::sort(found.begin(), found.end(), [](const Scenario& a, const Scenario& b) { return a.name < b.name; });
  return found;
}

}  // namespace

std::vector<Scenario> kept_scenarios(StepKind kind) {
  return scenarios_in(source_path("tests/scenarios"), kind);
}

std::vector<Scenario> examples(StepKind kind) { return scenarios_in(source_path("examples"), kind); }

std::vector<Scenario> data_scenarios(StepKind kind) {
  std::vector<Scenario> tasks = scenarios_in(data_folder() / "scenarios", kind);
  for (Scenario& task : tasks) task.public_task = true;
  return tasks;
}

EditFile read_scenario(const Scenario& scenario, int largest_resolution) {
  EditFile edit = read_edit_file(scenario.path);
  for (EditInput& input : edit.inputs)
    if (!input.sample.empty() && largest_resolution > 0)
      input.resolution =
          input.resolution == 0 ? largest_resolution : std::min(input.resolution, largest_resolution);
  return edit;
}

void visit_steps(const EditFile& edit, const RunOptions& options,
                 const std::function<void(const StepRun& run)>& visit) {
  std::map<std::string, MeshState> states = load_inputs(edit, {}).states;
  for (std::size_t i = 0; i < edit.steps.size(); ++i) {
    const EditStep& step = edit.steps[i];
    const Location location = (Location::file(edit.location) / "steps")[i];
    const std::map<std::string, MeshState> before = states;
    const StepReport report = run_step(edit, step, location, states, options, {});
    visit({edit, step, location, before, states.at(outcome_of(step)).mesh, report});
  }
}

ResolvedMerge resolve_merge(const StepRun& run) {
  const auto& step = std::get<MergeStep>(run.step.action);
  MergeSide source(facts::script::Side::source, run.edit, run.before.at(step.source)),
      target(facts::script::Side::target, run.edit, run.before.at(step.target));
  const MergeOutcome& outcome = run.report.merge.value();
  ResolvedMerge call{target.sound.mesh(), source.sound.mesh(),
                     resolve_pairs(step, source, target, run.location), outcome.options};
  if (outcome.posing.matrix() != Eigen::Matrix4d::Identity())
    call.source = transformed(call.source, outcome.posing, run.location);
  return call;
}

}  // namespace meshgraft::test
