#include <nanobind/nanobind.h>

#include <meshgraft/core/version.h>

#include "bindings.h"
#include "calls.h"
#include "errors.h"

namespace nb = nanobind;

NB_MODULE(_core, module) {
  using namespace meshgraft::python;
  module.attr("__version__") = MESHGRAFT_VERSION;
  module.def("note_fork", &note_fork);
  translate_errors();
  bind_mesh(module);
  bind_select(module);
  bind_repair(module);
  bind_deform(module);
  bind_vertex_deform(module);
  bind_live(module);
  bind_edit(module);
  bind_operators(module);
  bind_picture(module);
}
