#include <string>

#include <nanobind/nanobind.h>
#include <nanobind/stl/string.h>

#include <meshgraft/select/selection.h>

#include "arrays.h"
#include "bindings.h"
#include "calls.h"
#include "edits.h"
#include "mesh.h"
#include "script/selection_resolver.h"
#include "to_python.h"

namespace meshgraft::python {

namespace {

// Returns a location without the edit that only this function uses: "selection.sphere.radius", also within an
// array that was handed over under the name "selections.selection".
Location location_in_selection(const Location& location) {
  const std::string array = "selections.";
  for (std::size_t part = 0; part < location.parts().size(); ++part) {
    const std::string& name = location.parts()[part].name;
    if (name == "selection") return location.from(part);
    if (name.starts_with(array)) return Location::field(name.substr(array.size())) / location.from(part + 1);
  }
  return location;
}

// Resolves the selection `selections["selection"]` of an edit on a mesh, in the order that it has.
nb::object resolve_selection(const MeshHolder& holder, const nb::tuple& given, const nb::tuple& call) {
  try {
    const EditFile edit = edit_of(given).edit;
    return to_python(run_for(call_of(call), [&](const Context&) {
      const SelectionMesh context(*holder.mesh);
      const ProducedSets nothing_produced;  // the resolver refers to it
      SelectionResolver resolver(edit, context, nothing_produced);
      return resolver.ordered({EditSelection::Named{"selection"}}, {});
    }));
  } catch (const Error& error) {
    throw error.at(location_in_selection(error.location()));
  }
}

}  // namespace

void bind_select(nb::module_& module) { module.def("resolve_selection", &resolve_selection); }

}  // namespace meshgraft::python
