#pragma once

#include <meshgraft/mesh/mesh.h>

namespace meshgraft {

/// Two meshes as one: all vertices and faces of `first`, then those of `second`, with the attributes of both.
/// What one of them lacks is missing there (NaN). Attributes of one name and domain become one if they have
/// as many components; their labels are joined, and labels of one name that may stand for different things
/// (materials) are told apart by a suffix on the second's.
struct JoinResult {
  Mesh mesh;
  IndexMap first, second;
};

JoinResult join(const Mesh& first, const Mesh& second);

}  // namespace meshgraft
