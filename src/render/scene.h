#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include <Eigen/Core>

#include <meshgraft/mesh/mesh.h>

#include "render/render.h"

namespace meshgraft::render {

using Vec3 = Eigen::Vector3f;

/// The colour of what has none.
inline const Vec3 clay(0.50f, 0.395f, 0.32f);

/// All shapes of a picture as one triangle mesh. The shapes must outlive it.
struct Scene {
  /// The vertices of a shape.
  struct Part {
    const Points* positions;
    Eigen::RowVector3d offset;
  };
  std::vector<Part> parts;
  Triangles triangles;        ///< of finite vertices
  std::vector<Vec3> colours;  ///< per vertex, or empty for clay
  /// Per triangle, bit c: the edge opposite corner c belongs to the face. Empty unless they are drawn.
  std::vector<std::uint8_t> outlines;

  std::size_t vertex_count() const {
    std::size_t count = 0;
    for (const Part& part : parts) count += static_cast<std::size_t>(part.positions->rows());
    return count;
  }

  /// Runs body(position) for all vertices with finite coordinates.
  template <typename Body>
  void for_each_finite_position(Body body) const {
    for (const auto& [positions, offset] : parts)
      for (Eigen::Index v = 0; v < positions->rows(); ++v) {
        const Eigen::RowVector3d position = positions->row(v) + offset;
        if (position.allFinite()) body(Eigen::Vector3d(position.transpose()));
      }
  }
};

/// Triangulates and joins the shapes. Faces with a vertex that is not finite are left out. Throws Error(input)
/// if no face is left, or if a shape has not one colour per vertex.
Scene make_scene(std::span<const Shape> shapes, const RenderOptions& options);

}  // namespace meshgraft::render
