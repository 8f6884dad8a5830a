#pragma once

#include <meshgraft/mesh/mesh.h>

namespace meshgraft {

/// Measures of a finished seam.
struct SeamReport {
  bool manifold = false, oriented = false;
  bool closed = false;  ///< the result has no boundary
  Index euler_characteristic = 0, expected_euler_characteristic = 0;
  Index new_faces = 0;          ///< faces of the strip
  double angle_p1_deg = 0;      ///< 1st percentile of the smallest angles of the strip's triangles
  double dihedral_p99_deg = 0;  ///< 99th percentile over edges of the strip; 0° is flat
  /// The same for the neighbourhoods on both sides.
  double target_dihedral_p99_deg = 0, source_dihedral_p99_deg = 0;
  /// Largest displacement of a target vertex, × the diagonal of the result.
  double band_displacement_rel = 0;
  double source_edge_ratio = 1;  ///< mean edge length of the source's loops / that of the target's
};

}  // namespace meshgraft
