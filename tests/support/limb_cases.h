#pragma once

#include <vector>

#include <meshgraft/deform/deform_problem.h>

#include "support/mesh_families.h"

namespace meshgraft::test {

/// A straight pipe of radius 0.5 (round, or square with sides of 1) about the z axis.
struct LimbShape {
  bool square = false;
  double radii = 8;     ///< length between the held ends, × the radius
  bool uneven = false;  ///< triangles of one half are a third as long, and all are jittered
  bool closed = false;  ///< with a lid at both ends
};

struct Limb {
  TestMesh mesh;
  double length = 0;          ///< between the held ends, which are at z ≤ 0 and z ≥ length
  std::vector<Index> bottom;  ///< vertices at z ≤ 0
  std::vector<Index> top;     ///< vertices at z ≥ length
  std::vector<Index> middle;  ///< all others
};

Limb make_limb(const LimbShape& shape);

/// Returns the pose that turns the top about the axis.
HandlePose top_turned(double degrees);

/// Returns the helix: each vertex turns about the axis in proportion to its distance from the bottom.
Points helix(const Limb& limb, double degrees);

/// Returns the smallest distance of a vertex in the middle from the axis, × that at rest.
double waist(const Limb& limb, const Points& edited);

}  // namespace meshgraft::test
