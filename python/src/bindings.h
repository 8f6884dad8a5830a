#pragma once

#include <nanobind/nanobind.h>

namespace meshgraft::python {

// Each adds its subject to the extension module. The modules of python/meshgraft are the only callers of what
// they add.
void bind_mesh(nanobind::module_& module);
void bind_select(nanobind::module_& module);
void bind_repair(nanobind::module_& module);
void bind_deform(nanobind::module_& module);
void bind_vertex_deform(nanobind::module_& module);
void bind_live(nanobind::module_& module);
void bind_edit(nanobind::module_& module);
void bind_operators(nanobind::module_& module);
void bind_picture(nanobind::module_& module);

}  // namespace meshgraft::python
