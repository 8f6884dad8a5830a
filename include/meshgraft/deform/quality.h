#pragma once

#include <cstdint>
#include <optional>

#include <meshgraft/core/context.h>
#include <meshgraft/deform/edited_mesh.h>
#include <meshgraft/mesh/mesh.h>

namespace meshgraft {

/// Quality measures of a deformation. "Free" faces and edges touch a free vertex. A percentile pK is the
/// value of rank ⌈K/100 · n⌉ among the n sorted ones. Where there is nothing to measure, a number keeps its
/// value for an unmoved surface. Faces and edges of zero size or with non-finite coordinates are left out of
/// every measure that they do not define.
struct Quality {
  double area_ratio = 1;       ///< edited / rest, all faces
  double area_ratio_free = 1;  ///< edited / rest, free faces
  /// Edited / rest; absent unless the surface is closed and consistently oriented, and encloses a volume.
  std::optional<double> volume_ratio;
  double edge_rms = 0;  ///< RMS of the relative change of length over free edges
  /// In-plane singular values of the maps of all free faces, two per face: 1 = unchanged, 0 = collapsed.
  double sigma_min = 1, sigma_p1 = 1, sigma_p5 = 1, sigma_p50 = 1, sigma_p95 = 1, sigma_p99 = 1, sigma_max = 1;
  /// Change of the signed angle between the normals of two adjacent faces, 0 … 180 degrees, over free edges.
  double dihedral_p50_deg = 0, dihedral_p99_deg = 0, dihedral_max_deg = 0;
  /// Largest such change where held and free surface meet. These are edges between a free and a held vertex,
  /// and edges between a face that touches a free vertex and one that does not.
  double rim_jump_max_deg = 0;
  /// Free faces turned by > 90° against the mean normal of the faces around their corners (weighted by area
  /// at rest) that were not so at rest.
  Index flipped_faces = 0;
  /// Pairs of faces, at least one of them free, that intersect and did not at rest (deform/intersections.h).
  /// Absent if not asked for.
  std::optional<std::int64_t> new_self_intersections;
};

struct QualityOptions {
  bool self_intersections = true;  ///< takes several times as long as all other measures
};

/// Compares two states of a surface. Takes linear time, apart from self-intersections. The result does not
/// depend on the number of threads. Throws Error(usage) if the shapes differ or a free vertex does not exist,
/// Error(input) for a triangle's index out of range.
Quality measure_quality(const EditedMesh& mesh, const QualityOptions& options = {},
                        const Context& context = {});

}  // namespace meshgraft
