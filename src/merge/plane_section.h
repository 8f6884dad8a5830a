#pragma once

#include <vector>

#include <Eigen/Core>

#include <meshgraft/mesh/mesh.h>

#include "mesh/edge_table.h"

namespace meshgraft {

/// A closed curve in which a plane cuts a surface.
struct SectionLoop {
  Points points;  ///< in order
  Eigen::Vector3d centre = Eigen::Vector3d::Zero();
  double area = 0;  ///< negative for a curve around a hollow
  double length = 0;
  double overhang = 0;  ///< mean of the faces' normals along down, by length; 1: they face straight down

  double roundness() const;  ///< 1 for a circle, less for other curves
  double radius() const;     ///< of a circle of this length
};

/// A section of a surface by a plane.
struct PlaneSection {
  std::vector<SectionLoop> loops;  ///< the largest first
  bool closed = true;              ///< no curve ends at a boundary
  Index pieces = 0;                ///< connected pieces of the surface above that have a loop
};

/// Computes sections of a surface by planes, without cutting it. The constructor does the work that all planes
/// share.
class PlaneSections {
 public:
  /// Reverses the areas and normals of an inward-facing mesh.
  explicit PlaneSections(const Mesh& mesh);

  PlaneSection at(const Eigen::Vector3d& up, double height) const;

 private:
  Mesh surface_;  // triangles
  EdgeTable table_;
  double orientation_;
};

}  // namespace meshgraft
