#pragma once

#include <functional>
#include <span>
#include <vector>

#include <meshgraft/mesh/mesh.h>

#include "interpolate_attribute.h"

namespace meshgraft {

/// Returns the origin of an element that equals an element of the old mesh.
inline EdgePoint same(Index element) { return {element, element, 0}; }

/// Faces with their origins, per face and per corner.
struct TracedFaces {
  Faces faces;
  std::vector<Index> face_origin;
  std::vector<EdgePoint> corner_origin;

  void add(std::span<const Index> face, std::span<const EdgePoint> corners, Index origin);
};

/// Returns the mesh's faces in their order, with those `chosen` of more than three corners split into
/// triangles.
TracedFaces triangulate_chosen(const Mesh& mesh, const std::function<bool(Index face)>& chosen,
                               const TriangulateOptions& options = {});

}  // namespace meshgraft
