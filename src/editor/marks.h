#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include <Eigen/Core>

#include <meshgraft/mesh/diagnostics.h>

#include "deform/measure/print_check.h"
#include "objects.h"

namespace meshgraft::editor {

/// Places of a surface that the page lights up, as positions in model units, so that they need no mesh on the
/// page. Elements with a coordinate that is not finite are left out.
struct Marks {
  std::vector<Eigen::RowVector3d> points;     ///< one per point
  std::vector<Eigen::RowVector3d> lines;      ///< two per line
  std::vector<Eigen::RowVector3d> triangles;  ///< three per triangle

  bool empty() const { return points.empty() && lines.empty() && triangles.empty(); }
};

/// Returns the places of a finding on the object's mesh: edges as lines, faces as triangles with their
/// outlines, components as triangles, and other vertices as points. For vertices without a finite position and
/// for outlying ones, these are the other corners of their faces.
Marks marks_of(const Object& object, const Finding& finding);

/// The findings of a print check that have places.
enum class PrintFinding { open_edges, non_manifold_edges, turned_edges, intersections, thin_walls, overhangs };

/// Returns the places of a finding on the mesh that was checked.
Marks marks_of(const Mesh& mesh, const PrintCheck& check, PrintFinding finding);

/// Returns the message `marks` about the mesh of an object.
std::vector<std::byte> marks_frame(const Object& object, const Marks& marks);

}  // namespace meshgraft::editor
