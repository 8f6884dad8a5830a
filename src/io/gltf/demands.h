#pragma once

#include <string>
#include <utility>
#include <vector>

#include <meshgraft/core/context.h>
#include <meshgraft/mesh/mesh.h>

#include "document.h"
#include "edit.h"

namespace meshgraft::io {

/// What one accessor would have to hold for one instance to look like the mesh.
struct GltfDemand {
  GltfChannel channel;
  std::size_t accessor = 0;
  Flags is_used;        ///< elements that some corner of the instance has
  GltfChanges changes;  ///< in the file's space: of the elements whose values differ from the file's

  bool is_met() const { return changes.empty(); }
};

/// The demands of one instance, in a fixed order.
using GltfDemands = std::vector<GltfDemand>;

/// Compares a mesh with what the reader made of its file: demands per instance. `notes` gets a sentence where
/// corners want different values of one element; the first one's is taken.
/// Throws Error(input) where a node flattens what was moved.
std::vector<GltfDemands> demands_of(const GltfDocument& document, const Mesh& mesh,
                                    std::vector<std::string>& notes, const Context& context);

/// Equal but for the rounding of a node's transform.
bool nearly_equal(const GltfValue& a, const GltfValue& b);

/// A mesh of the file with the instance whose demands it has to meet.
struct GltfTarget {
  std::size_t mesh = 0;  ///< in the edit's JSON
  std::size_t instance = 0;
};

/// Gives instances whose demands differ a mesh of their own, appended to the JSON; nodes that are not shown and
/// instances without an edit keep the old one. Returns the meshes that have to change.
std::vector<GltfTarget> part_instances(GltfEdit& edit, const GltfDocument& document,
                                       const std::vector<GltfDemands>& demands);

}  // namespace meshgraft::io
