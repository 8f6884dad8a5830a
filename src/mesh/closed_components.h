#pragma once

#include <vector>

#include <meshgraft/core/context.h>
#include <meshgraft/mesh/mesh.h>

#include "edge_table.h"

namespace meshgraft {

/// The connected parts of a mesh that face inward: closed, consistently oriented, of negative volume, and not
/// the wall of a cavity, that is inside no other closed part.
struct InwardComponents {
  std::vector<Index> component;   ///< per vertex the smallest vertex that is connected with it by edges
  std::vector<Index> components;  ///< those that face inward, by their smallest vertex, ascending
};

InwardComponents inward_components(const Mesh& mesh, const EdgeTable& table, const Context& context = {});

}  // namespace meshgraft
