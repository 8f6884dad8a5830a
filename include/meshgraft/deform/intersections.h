#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include <meshgraft/core/context.h>
#include <meshgraft/deform/edited_mesh.h>
#include <meshgraft/mesh/mesh.h>

namespace meshgraft {

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
