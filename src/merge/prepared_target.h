#pragma once

#include <memory>
#include <vector>

#include <Eigen/Core>

#include <meshgraft/core/context.h>
#include <meshgraft/mesh/mesh.h>
#include <meshgraft/mesh/topology.h>

#include "open_hole.h"

namespace meshgraft {

/// A target with the data that every drop needs.
struct PreparedTarget {
  PreparedTarget(std::shared_ptr<const Mesh> shared_mesh, const Context& context);

  std::shared_ptr<const Mesh> shared;
  const Mesh& mesh;
  Triangles triangles;
  std::vector<Index> face_of_triangle;
  IndexLists rings;
  Points normals;

 private:
  PreparedTarget(std::shared_ptr<const Mesh> shared_mesh, Triangulation triangulation, const Context& context);
};

/// A point of a surface, with its vertex or the corners of its triangle.
struct SurfacePoint {
  Eigen::RowVector3d point;
  std::vector<Index> corners;
};

/// Throws Error(input) for numbers of a drop that are not finite or out of range.
void validate(const Drop& drop, const Mesh& target);

/// Returns the surface point that a drop names, however far from the surface. Throws Error(input) at
/// `surface_point` for a vertex without a face.
SurfacePoint locate(const PreparedTarget& target, const Drop& drop);

/// Returns the surface point that a drop names. Throws Error(input) at `surface_point` for a vertex without a
/// face, and for a point farther from the surface than a twentieth of the target's diagonal.
SurfacePoint find_surface_point(const PreparedTarget& target, const Drop& drop);

/// Returns the point of the surface nearest to `point`, however far. There must be a triangle.
SurfacePoint find_nearest_point(const Points& positions, const Triangles& triangles,
                                const Eigen::RowVector3d& point);

/// Returns the unit normal averaged over a distance along the surface around a point. Where the surface
/// curves right round within that distance, returns the normal at the point.
Eigen::RowVector3d mean_normal(const PreparedTarget& target, const SurfacePoint& point, double distance);

}  // namespace meshgraft
