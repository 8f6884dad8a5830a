#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <nanobind/nanobind.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/vector.h>

#include <meshgraft/io/mesh_io.h>
#include <meshgraft/script/report.h>
#include <meshgraft/script/run_edit.h>

#include "arrays.h"
#include "bindings.h"
#include "calls.h"
#include "edits.h"
#include "errors.h"
#include "from_python.h"
#include "mesh.h"
#include "records.h"
#include "script/compare.h"
#include "to_python.h"

namespace meshgraft::python {

GivenEdit edit_of(const nb::tuple& given) {
  GivenEdit result;
  result.edit = parse_edit(nb::cast<std::string>(given[0]), nb::cast<std::string>(given[1]),
                           nb::cast<std::string>(given[2]));
  const auto arrays = nb::cast<nb::dict>(given[3]);
  for (NamedSelection& named : result.edit.selections)
    if (arrays.contains(named.name.c_str()))
      named.selection.kind = Selection::Indices{indices_of(nb::cast<IndicesIn>(arrays[named.name.c_str()]))};
  for (const auto& [name, mesh] : nb::cast<nb::dict>(given[4]))
    result.meshes.emplace(nb::cast<std::string>(name), nb::cast<const MeshHolder&>(mesh).mesh);
  return result;
}

GivenEdit edit_of_arguments(const nb::tuple& given) {
  return without_step([&] { return edit_of(given); });
}

Location argument_location(const Location& location) {
  constexpr std::size_t step_parts = 3;  // the edit, "steps", [0]
  const std::vector<LocationPart>& parts = location.parts();
  if (parts.size() < step_parts) return location;
  if (parts[1].name == "steps") {
    const bool is_setting = parts.size() > step_parts + 1 && parts[step_parts].name == "settings";
    return location.from(is_setting ? step_parts + 1 : step_parts);
  }
  const std::string step = "steps[0].", name = parts[2].name;
  if (parts[1].name != "selections" || !name.starts_with(step)) return location;
  return Location::field(name.substr(step.size())) / location.from(step_parts);
}

LoadedInputs inputs_of(const GivenEdit& given, const Context& context) {
  EditFile others = given.edit;
  std::erase_if(others.inputs, [&](const EditInput& input) { return given.meshes.contains(input.name); });
  LoadedInputs inputs = load_inputs(others, context);
  std::vector<EditReport::Input> reports;
  for (const EditInput& input : given.edit.inputs) {
    if (const auto found = given.meshes.find(input.name); found != given.meshes.end()) {
      context.step("check");
      for (const Note& note : notes_on_files(*found->second)) inputs.notes.push_back(note);
      MeshState state = make_input_state(input, *found->second, input.name, context);
      reports.push_back(
          {input.name, state.label, state.mesh.vertex_count(), state.mesh.face_count(), state.diagnostics});
      inputs.states.emplace(input.name, std::move(state));
    } else {
      for (EditReport::Input& report : inputs.reports)
        if (report.name == input.name) reports.push_back(report);
    }
  }
  inputs.reports = std::move(reports);
  return inputs;
}

namespace {

RunOptions run_options_of(const nb::dict& overrides, const nb::dict& options) {
  RunOptions run;
  run.overrides = options_of<SettingsOverrides>(overrides);
  run.estimate_condition = nb::cast<bool>(options["estimate_condition"]);
  run.strict = nb::cast<bool>(options["strict"]);
  run.keep = nb::cast<std::vector<std::string>>(options["keep"]);
  if (!options["memory"].is_none()) run.memory = nb::cast<std::uint64_t>(options["memory"]);
  return run;
}

// Returns (mesh, rest, report, {name: kept mesh}).
nb::tuple result_of(EditResult result) {
  nb::dict kept;
  for (auto& [name, mesh] : result.kept) kept[name.c_str()] = to_python(std::move(mesh));
  nb::object report = to_python(result.report);
  return nb::make_tuple(to_python(std::move(result.mesh)), array_of(std::move(result.rest)), report, kept);
}

nb::tuple run_given(const nb::tuple& given, const nb::dict& overrides, const nb::dict& options,
                    const nb::tuple& call) {
  const GivenEdit edit = edit_of(given);
  const RunOptions run_options = run_options_of(overrides, options);
  require_kept(edit.edit, run_options);
  return result_of(run_for(call_of(call), [&](const Context& context) {
    return run_steps(edit.edit, inputs_of(edit, context), run_options, context);
  }));
}

// Runs an edit of one step, and tells errors at the fields of that step.
nb::tuple run_one_step(const nb::tuple& given, const nb::dict& options, const nb::tuple& call) {
  return without_step([&] { return run_given(given, nb::dict(), options, call); });
}

nb::list compare(const nb::tuple& given, const std::vector<std::string>& names, const nb::tuple& call) {
  const GivenEdit edit = edit_of(given);
  std::vector<Contender> methods;
  for (const std::string& name : names) methods.push_back(contender_named(name));
  if (names.empty()) methods = all_contenders();
  Comparison comparison = run_for(call_of(call), [&](const Context& context) {
    return compare_methods(edit.edit, inputs_of(edit, context), methods, context);
  });
  nb::list outcomes;
  for (MethodOutcome& outcome : comparison.outcomes)
    outcomes.append(nb::make_tuple(
        to_python(to_string(outcome.method)),
        outcome.result ? nb::object(result_of(*std::move(outcome.result))) : nb::object(nb::none()),
        outcome.failure ? exception_of(*outcome.failure) : nb::object(nb::none())));
  return outcomes;
}

}  // namespace

void bind_edit(nb::module_& module) {
  module.def("run_edit", &run_given);
  module.def("run_one_step", &run_one_step);
  module.def("compare", &compare);
  // Checks an edit, and returns it as a version 2 file; `saved`: as one that this library wrote.
  module.def("normalised_edit", [](const nb::tuple& given, bool saved) {
    EditFile edit = edit_of(given).edit;
    if (saved) edit.made_with = this_library();
    return write_edit(edit);
  });
  module.def("read_edit", [](const std::string& path) { return write_edit(read_edit_file(path)); });
  module.def("methods", [] {
    nb::list names;
    for (const Method& method : all_methods()) names.append(to_python(method));
    return names;
  });
}

}  // namespace meshgraft::python
