#pragma once

#include <functional>
#include <span>
#include <vector>

#include <meshgraft/mesh/interpolate_attribute.h>
#include <meshgraft/mesh/mesh.h>

namespace meshgraft {

/// An element of a new mesh that is an old one.
inline EdgePoint same(Index element) { return {element, element, 0}; }

/// Faces with, per face and per corner, where they come from.
struct TracedFaces {
  Faces faces;
  std::vector<Index> face_origin;
  std::vector<EdgePoint> corner_origin;

  void add(std::span<const Index> face, std::span<const EdgePoint> corners, Index origin);
};

/// The mesh's faces in their order, those with more than three corners that are `chosen` as triangles.
TracedFaces triangulate_chosen(const Mesh& mesh, const std::function<bool(Index face)>& chosen,
                               const TriangulateOptions& options = {});

}  // namespace meshgraft
