#pragma once

#include <array>

#include "predicates.h"

namespace meshgraft {

using Triangle3 = std::array<Point3, 3>;

/// Whether the corners are finite and not collinear. Exact.
bool has_area(const Triangle3& t);

/// Whether two closed triangles with area have a point in common. Exact. Guigue and Devillers 2003, "Fast and
/// robust triangle-triangle overlap test using orientation predicates"; in one plane by separating lines.
bool triangles_intersect(const Triangle3& a, const Triangle3& b);

/// Whether two triangles with area have more in common than corners that they share: the first `shared` (0 to
/// 3) of both. Three shared corners are one triangle, which counts as no intersection. Exact.
bool intersect_beyond_shared(const Triangle3& a, const Triangle3& b, int shared);

}  // namespace meshgraft
