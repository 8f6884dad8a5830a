#pragma once

#include <map>
#include <memory>
#include <string>

#include <nanobind/nanobind.h>

#include <meshgraft/script/edit_file.h>

#include "script/run_steps.h"

namespace meshgraft::python {

namespace nb = nanobind;

/// An edit as the front hands it over.
struct GivenEdit {
  EditFile edit;
  std::map<std::string, std::shared_ptr<const Mesh>> meshes;  ///< inputs in memory, by their names
};

/// Reads the front's tuple (text, location, base folder, arrays, meshes). `text` is an edit file. `arrays` has
/// the vertices of those named selections whose text is only a placeholder, so that long lists need not become
/// text.
GivenEdit edit_of(const nb::tuple& given);

/// Reads and checks the inputs: those in memory, and the others from files and samples.
LoadedInputs inputs_of(const GivenEdit& given, const Context& context);

/// Runs a function that throws errors at "EDIT: steps[0].field", and throws them at "field" instead. For edits
/// of one step that Python's user has not seen.
template <class Work>
auto without_step(const Work& work) {
  try {
    return work();
  } catch (const Error& error) {
    constexpr std::size_t step_parts = 3;  // the edit, "steps", [0]
    const auto& parts = error.location().parts();
    const bool inside = parts.size() >= step_parts && parts[1].name == "steps";
    throw inside ? error.at(error.location().from(step_parts)) : error;
  }
}

}  // namespace meshgraft::python
