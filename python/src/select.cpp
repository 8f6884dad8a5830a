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

// Resolves the selection `selections["selection"]` of an edit on a mesh, in the order that it has.
nb::object resolve_selection(const MeshHolder& holder, const nb::tuple& given, const nb::tuple& call) {
  const EditFile edit = edit_of(given).edit;
  return to_python(run_for(call_of(call), [&](const Context&) {
    const SelectionMesh context(*holder.mesh);
    const ProducedSets nothing_produced;  // the resolver refers to it
    SelectionResolver resolver(edit, context, nothing_produced);
    try {
      return resolver.ordered({EditSelection::Named{"selection"}}, {});
    } catch (const Error& error) {
      // Without the name that only this function uses.
      for (std::size_t part = 0; part < error.location().parts().size(); ++part)
        if (error.location().parts()[part].name == "selection") throw error.at(error.location().from(part));
      throw;
    }
  }));
}

}  // namespace

void bind_select(nb::module_& module) { module.def("resolve_selection", &resolve_selection); }

}  // namespace meshgraft::python
