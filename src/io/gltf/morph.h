#pragma once

#include <string>
#include <vector>

#include "demands.h"
#include "edit.h"

namespace meshgraft::io {

/// Throws Error(usage) unless the target's rest positions are those that the reader made of the file.
void require_rest_of_file(const GltfDocument& document, const Mesh& mesh, const MorphTarget& target,
                          const Context& context);

/// Adds the demands as one more morph target to every primitive of the meshes that have any: differences of
/// positions, and of normals and tangents where earlier targets have them too. Default weights, those of nodes
/// and of animations get a zero for it, `extras.targetNames` its name.
void add_morph_target(GltfEdit& edit, const std::vector<GltfTarget>& targets,
                      const std::vector<GltfDemands>& demands, const std::string& name);

/// A VEC3 accessor of `count` floats that is zero but for `deltas`: sparse where few differ.
std::size_t append_deltas(GltfEdit& edit, std::size_t count, const GltfChanges& deltas, bool with_bounds);

/// Names target number `number` in `extras.targetNames`, where programs look for it.
void name_target(GltfEdit& edit, Json& mesh, std::size_t number, const std::string& name);

}  // namespace meshgraft::io
