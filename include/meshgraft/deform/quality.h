#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include <meshgraft/core/context.h>
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
  /// Smallest width of the body that the surface encloses, edited / rest. The width at a free vertex is the
  /// distance to the opposite point, where a ray from the vertex at rest against its normal leaves the body.
  /// The opposite point moves with its triangle. Widths count from an edge's length up to the size of the free
  /// part. Of more than 20,000 free vertices, that many are measured, evenly spread over their numbers.
  double width_min = 1;
  Index narrowest_vertex = -1;  ///< where that is; -1 if no free vertex has a width
  /// Free faces turned by > 90° against the mean normal of the faces around their corners (weighted by area
  /// at rest) that were not so at rest.
  Index flipped_faces = 0;
  /// Pairs of faces, at least one of them free, that intersect and did not at rest (exact).
  /// Absent if not asked for.
  std::optional<std::int64_t> new_self_intersections;
};

struct QualityOptions {
  bool self_intersections = true;  ///< takes several times as long as all other measures
};

/// Compares two states of a surface. Takes O(m log m) time. The result does not
/// depend on the number of threads. Throws Error(usage) if the shapes differ or a free vertex does not exist,
/// Error(input) for a triangle's index out of range.
Quality measure_quality(const EditedMesh& mesh, const QualityOptions& options = {},
                        const Context& context = {});

/// Two triangles by their rows, the smaller one first.
using TrianglePair = std::array<Index, 2>;

/// Returns the pairs of triangles of a surface that intersect and of which at least one is free (touches a
/// free vertex). `points` is n×3, `triangles` m×3; the pairs are in lexicographic order. Triangles are
/// closed, so touching counts as intersecting. A shared vertex or edge does not count by itself; only other
/// common points do. Two triangles with the same three vertices never count. Triangles without area or with a
/// non-finite coordinate are ignored. The test is exact for the given coordinates (Guigue and Devillers 2003
/// on orientations after Shewchuk 1997). The result does not depend on the number of threads.
///
/// Takes O(m log m) time, and more where the triangles' bounding boxes crowd. The worst case, all triangles
/// in one location, takes O(m²). The function reports progress as the stage "intersections" and can be
/// cancelled. Throws Error(usage) if a free vertex does not exist, and Error(input) for a triangle's index
/// out of range. Throws Error(memory) if the pairs would take more than an eighth of the available memory.
std::vector<TrianglePair> self_intersections(const Points& points, const Triangles& triangles,
                                             std::span<const Index> free_vertices, const Context& context = {});

/// Returns the number of pairs of `self_intersections`. It does not store the pairs, and throws no
/// Error(memory).
std::int64_t count_self_intersections(const Points& points, const Triangles& triangles,
                                      std::span<const Index> free_vertices, const Context& context = {});

/// Returns the pairs of `self_intersections` in the edited state that do not intersect at rest. Throws
/// Error(usage) if the shapes differ, and otherwise what `self_intersections` throws.
std::vector<TrianglePair> new_self_intersections(const EditedMesh& mesh, const Context& context = {});

/// Returns the number of pairs of `new_self_intersections` without storing them.
std::int64_t count_new_self_intersections(const EditedMesh& mesh, const Context& context = {});

}  // namespace meshgraft
