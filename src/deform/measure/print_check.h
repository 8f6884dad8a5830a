#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <vector>

#include <Eigen/Core>

#include <meshgraft/core/context.h>
#include <meshgraft/deform/quality.h>
#include <meshgraft/mesh/mesh.h>

namespace meshgraft {

struct PrintCheckOptions {
  Eigen::Vector3d up = Eigen::Vector3d::UnitZ();  ///< away from the bed; of any length but 0
  /// A face hangs over if it faces downward by more than this angle from the vertical, degrees: 0 for a wall,
  /// 90 for a ceiling.
  double overhang_deg = 45;
  double least_wall = 0;  ///< thinnest wall that can be printed, model units
};

/// Measures of a surface that is to be printed. Triangles are rows of the triangulation.
struct PrintCheck {
  Triangulation surface;
  Eigen::Vector3d size = Eigen::Vector3d::Zero();  ///< sides of the bounding box
  double area = 0;
  /// Volume that the surface encloses; absent unless it is closed and consistently oriented.
  std::optional<double> volume;
  bool inside_out = false;                               ///< the volume is negative
  std::vector<std::array<Index, 2>> open_edges;          ///< edges of one face, by their ends
  Index holes = 0;                                       ///< boundary loops
  std::vector<std::array<Index, 2>> non_manifold_edges;  ///< edges of more than two faces
  std::vector<std::array<Index, 2>> turned_edges;        ///< edges whose two faces are oriented inconsistently
  std::vector<TrianglePair> intersections;               ///< as `self_intersections`
  /// Thickness of the thinnest wall, model units; absent if no face has another behind it. The thickness at a
  /// face is the length of the ray from its centre against its normal, until it leaves the body through a face
  /// within 30° of parallel that shares no vertex with it.
  std::optional<double> thinnest_wall;
  /// Triangles where the wall is thinner than `least_wall`; if there are none, where it is at most a tenth
  /// thicker than the thinnest.
  std::vector<Index> thin;
  std::vector<Index> overhanging;  ///< triangles that hang over and do not lie on the bed
  double overhang_area = 0;
};

/// Checks a surface before it is printed. Faces with an index out of range, and triangles with a coordinate
/// that is not finite, are left out. The result does not depend on the number of threads. Throws Error(memory)
/// as `self_intersections` does, and Error(cancelled).
PrintCheck check_print(const Mesh& mesh, const PrintCheckOptions& options = {}, const Context& context = {});

}  // namespace meshgraft
