#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include <meshgraft/core/context.h>
#include <meshgraft/mesh/topology.h>

#include "scene.h"

namespace meshgraft::render {

/// The normals at the corners of those triangles that a picture shows. They are means over the triangles around
/// the vertex, weighted by area, but not across creases.
class CornerNormals {
 public:
  CornerNormals(const std::vector<Vec3>& points, const Triangles& triangles, const RenderOptions& options,
                const Context& context);

  /// Computes the normals of triangles that samples show, if they are not known yet.
  void add(const std::vector<std::uint32_t>& seen, const Context& context);

  /// Returns the three unit normals of a triangle that was added.
  const std::array<Vec3, 3>& of(std::uint32_t triangle) const { return normals_[slots_[triangle]]; }

 private:
  /// Returns the unit normal times twice the area.
  Vec3 area_vector(Index triangle) const;
  Vec3 normal_at(std::uint32_t triangle, int corner) const;

  const std::vector<Vec3>& points_;
  const Triangles& triangles_;
  bool smooth_;
  IndexLists around_;  ///< triangles by vertex, if normals are smooth
  float least_cosine_;
  std::vector<std::uint32_t> slots_;  ///< by triangle
  std::vector<std::array<Vec3, 3>> normals_;
};

}  // namespace meshgraft::render
