#pragma once

#include <span>

#include <meshgraft/mesh/mesh.h>

namespace meshgraft {

/// Two states of a surface, by reference: its vertices at rest and edited (both n×3, model units), its
/// triangles (m×3), and the vertices that the edit could move.
struct EditedMesh {
  const Points& rest;
  const Points& edited;
  const Triangles& triangles;
  std::span<const Index> free_vertices;
};

}  // namespace meshgraft
