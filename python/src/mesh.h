#pragma once

#include <memory>

#include <nanobind/nanobind.h>

#include <meshgraft/mesh/mesh.h>

namespace meshgraft::python {

/// Stands behind Python's Mesh. Nobody changes the mesh once it is made, so that arrays may show its memory.
struct MeshHolder {
  std::shared_ptr<const Mesh> mesh;
};

}  // namespace meshgraft::python
