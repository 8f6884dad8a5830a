#pragma once

#include <array>
#include <cstdint>
#include <optional>
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
/// Decided exactly for the coordinates as they are; the result does not depend on the number of threads.
/// Empty optional where it cannot be told: in a build without CGAL, and where triangles crowd so much that more
/// than `max_intersection_candidates` pairs have overlapping bounding boxes (time grows with those).
/// Throws Error(usage) if a free vertex does not exist, Error(input) for a triangle's index out of range.
std::optional<std::vector<TrianglePair>> self_intersections(const Points& points, const Triangles& triangles,
                                                            std::span<const Index> free_vertices,
                                                            const Context& context = {});

/// Of these, in `edited`, the ones that do not intersect in `rest` (both n×3). Throws Error(usage) if the
/// shapes differ, else as above.
std::optional<std::vector<TrianglePair>> new_self_intersections(const Points& rest, const Points& edited,
                                                                const Triangles& triangles,
                                                                std::span<const Index> free_vertices,
                                                                const Context& context = {});

/// A surface of m triangles that is no more crowded than usual has some 10 m.
inline constexpr std::int64_t max_intersection_candidates = 50'000'000;

}  // namespace meshgraft
