#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include <meshgraft/core/context.h>
#include <meshgraft/mesh/mesh.h>

namespace meshgraft {

/// Two triangles by their rows, the smaller one first.
using TrianglePair = std::array<Index, 2>;

/// The pairs of triangles of a surface that intersect, at least one of them free (touching a free vertex), in
/// lexicographic order: `points` n×3, `triangles` m×3. Triangles are closed, so touching is intersecting, but a
/// vertex or an edge that two triangles share does not count, only what they have in common beyond it; those
/// with the same three vertices never do. Triangles without area or with a non-finite coordinate take no part.
/// Decided exactly for the coordinates as they are (Guigue and Devillers 2003 on orientations after Shewchuk
/// 1997); the result does not depend on the number of threads.
///
/// Takes O(m log m), and more where boxes of parts crowd: in the worst case, all triangles in one place, O(m²).
/// Then it reports progress as the stage "intersections", and can be cancelled.
/// Throws Error(usage) if a free vertex does not exist, Error(input) for a triangle's index out of range,
/// Error(memory) if the pairs would take more than an eighth of the memory that there is.
std::vector<TrianglePair> self_intersections(const Points& points, const Triangles& triangles,
                                             std::span<const Index> free_vertices, const Context& context = {});

/// How many these are. Takes no memory for them, and throws no Error(memory).
std::int64_t count_self_intersections(const Points& points, const Triangles& triangles,
                                      std::span<const Index> free_vertices, const Context& context = {});

/// Of these pairs, in `edited`, the ones that do not intersect in `rest` (both n×3). Throws Error(usage) if the
/// shapes differ, else as above.
std::vector<TrianglePair> new_self_intersections(const Points& rest, const Points& edited,
                                                 const Triangles& triangles,
                                                 std::span<const Index> free_vertices,
                                                 const Context& context = {});

/// How many those are, without memory for them.
std::int64_t count_new_self_intersections(const Points& rest, const Points& edited, const Triangles& triangles,
                                          std::span<const Index> free_vertices, const Context& context = {});

}  // namespace meshgraft
