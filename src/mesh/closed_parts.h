#pragma once

#include <vector>

#include <meshgraft/core/context.h>
#include <meshgraft/mesh/mesh.h>

#include "edge_table.h"

namespace meshgraft {

/// The connected parts of a mesh that face inward: closed, consistently oriented, of negative volume, and not
/// the wall of a cavity, that is inside no other closed part.
struct InwardParts {
  std::vector<Index> part;   ///< per vertex the smallest vertex that is connected with it by edges
  std::vector<Index> parts;  ///< those that face inward, by their smallest vertex, ascending
};

InwardParts inward_parts(const Mesh& mesh, const EdgeTable& table, const Context& context = {});

}  // namespace meshgraft
