#pragma once

#include <utility>
#include <vector>

#include <meshgraft/core/context.h>
#include <meshgraft/core/error.h>
#include <meshgraft/mesh/mesh.h>

#include "document.h"
#include "edit.h"

namespace meshgraft::io {

/// The values that one accessor must hold so that one instance looks like the mesh.
struct GltfDemand {
  GltfChannel channel;
  std::size_t accessor = 0;
  Flags is_used;        ///< per element: whether a corner of the instance uses it
  GltfChanges changes;  ///< elements whose values differ from the file's, in the file's space

  bool is_met() const { return changes.empty(); }
};

/// The demands of one instance, in a fixed order.
using GltfDemands = std::vector<GltfDemand>;

/// Compares a mesh with the values that the reader derived from its file. Returns the demands of each
/// instance. If corners want different values of one element, the first corner's value is taken and `notes`
/// gets a note. Throws Error(input) with the id gltf.node_flattens if an edited instance belongs to a
/// node that flattens its mesh.
std::vector<GltfDemands> demands_of(const GltfDocument& document, const Mesh& mesh, std::vector<Note>& notes,
                                    const Context& context);

/// Returns whether two values are equal up to the rounding of a node's transform.
bool nearly_equal(const GltfValue& a, const GltfValue& b);

/// A mesh of the file, and the instance whose demands it must meet.
struct GltfTarget {
  std::size_t mesh = 0;  ///< in the edit's JSON
  std::size_t instance = 0;
};

/// Gives instances with different demands separate meshes, which are appended to the JSON. Nodes that are not
/// shown and instances without an edit keep the old mesh. Returns the meshes that must change.
std::vector<GltfTarget> part_instances(GltfEdit& edit, const GltfDocument& document,
                                       const std::vector<GltfDemands>& demands);

}  // namespace meshgraft::io
