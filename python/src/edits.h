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

/// The same for an edit of one step, whose fields are the arguments of a call: errors name these.
GivenEdit edit_of_arguments(const nb::tuple& given);

/// Reads and checks the inputs: those in memory, and the others from files and samples.
LoadedInputs inputs_of(const GivenEdit& given, const Context& context);

/// Returns the argument that is meant by a location in an edit of one step that Python's user has not seen:
/// "field" for "EDIT: steps[0].field", for "EDIT: steps[0].settings.field", and for an array that was handed
/// over under the name "steps[0].field".
Location argument_location(const Location& location);

/// Runs a function that throws errors at locations in such an edit, and throws them at arguments instead.
template <class Work>
auto without_step(const Work& work) {
  try {
    return work();
  } catch (const Error& error) {
    throw error.at(argument_location(error.location()));
  }
}

}  // namespace meshgraft::python
