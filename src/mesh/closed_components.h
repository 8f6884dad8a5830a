#pragma once

#include <vector>

#include <meshgraft/core/context.h>
#include <meshgraft/mesh/mesh.h>

#include "edge_table.h"
#include "simple_surface.h"

namespace meshgraft {

/// The connected components of a mesh that face inward: closed, consistently oriented and of negative volume.
/// A component inside another closed component is excluded, because it is the wall of a cavity.
struct InwardComponents {
  std::vector<Index> component;   ///< per vertex: the smallest vertex of its connected component
  std::vector<Index> components;  ///< inward-facing ones, by their smallest vertex, ascending
};

InwardComponents inward_components(const Mesh& mesh, const EdgeTable& table, const Context& context = {});

/// Returns the same for a mesh with a simple surface.
InwardComponents inward_components(const Mesh& mesh, const SimpleSurface& surface, const Context& context = {});

}  // namespace meshgraft
