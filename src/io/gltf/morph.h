#pragma once

#include <string>
#include <vector>

#include "demands.h"
#include "edit.h"

namespace meshgraft::io {

/// Throws Error(usage) with the id gltf.rest_not_of_file unless the target's rest positions are the positions
/// that the reader derived from the file.
void require_rest_of_file(const GltfDocument& document, const Mesh& mesh, const MorphTarget& target,
                          const Context& context);

/// Adds the demands as one more morph target to every primitive of the given meshes. It holds differences of
/// positions, and of normals and tangents unless earlier targets lack them.
///
/// Default weights and the weights of nodes and animations get a zero for the target. `extras.targetNames`
/// gets its name.
void add_morph_target(GltfEdit& edit, const std::vector<GltfTarget>& targets,
                      const std::vector<GltfDemands>& demands, const std::string& name);

/// Appends a VEC3 accessor of `count` floats that is zero except for `deltas`. It is sparse if few elements
/// differ.
std::size_t append_deltas(GltfEdit& edit, std::size_t count, const GltfChanges& deltas, bool with_bounds);

/// Names target number `number` in `extras.targetNames`, where programs look for names.
void name_target(GltfEdit& edit, Json& mesh, std::size_t number, const std::string& name);

}  // namespace meshgraft::io
