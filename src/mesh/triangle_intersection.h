#pragma once

#include <array>

#include "predicates.h"

namespace meshgraft {

using Triangle3 = std::array<Point3, 3>;

/// Returns whether the corners are finite and not collinear. Exact.
bool has_area(const Triangle3& t);

/// Returns whether two closed triangles with area have a point in common. Exact. Uses Guigue and Devillers
/// 2003, "Fast and robust triangle-triangle overlap test using orientation predicates"; in one plane,
/// separating lines.
bool triangles_intersect(const Triangle3& a, const Triangle3& b);

/// Returns whether two triangles with area have more in common than their shared corners: the first `shared`
/// (0 to 3) of both. Three shared corners make the same triangle, which counts as no intersection. Exact.
bool intersect_beyond_shared(const Triangle3& a, const Triangle3& b, int shared);

}  // namespace meshgraft
