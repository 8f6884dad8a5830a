#include "triangle_intersection.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <span>
#include <utility>

namespace meshgraft {

namespace {

using Signs = std::array<int, 3>;

// Returns on which side of the plane of `t` each corner of `other` lies, from the corner `first` on; 0 before
// it.
Signs plane_sides(const Triangle3& t, const Triangle3& other, std::size_t first) {
  Signs sides{};
  for (std::size_t k = first; k < 3; ++k) sides[k] = orient3d(t[0], t[1], t[2], other[k]);
  return sides;
}

bool strictly_on_one_side(const Signs& sides, std::size_t first) {
  return sides[first] != 0 && std::all_of(sides.begin() + static_cast<std::ptrdiff_t>(first), sides.end(),
                                          [&](int side) { return side == sides[first]; });
}

Point2 project(const Point3& p, std::size_t axis) { return {p[(axis + 1) % 3], p[(axis + 2) % 3]}; }

// A triangle projected along an axis that does not flatten it, in counter-clockwise order.
struct PlaneView {
  std::size_t axis = 0;
  std::array<Point2, 3> corners;

  explicit PlaneView(const Triangle3& t) {
    for (; axis < 3; ++axis) {
      for (std::size_t k = 0; k < 3; ++k) corners[k] = project(t[k], axis);
      const int turn = orient2d(corners[0], corners[1], corners[2]);
      if (turn == 0) continue;
      if (turn < 0) std::swap(corners[1], corners[2]);
      return;
    }
  }
};

// Returns whether an edge of the convex, counter-clockwise `polygon` has all `points` strictly beyond it.
bool an_edge_separates(std::span<const Point2> polygon, std::span<const Point2> points) {
  for (std::size_t k = 0; k < polygon.size(); ++k) {
    const Point2& from = polygon[k];
    const Point2& to = polygon[(k + 1) % polygon.size()];
    if (std::all_of(points.begin(), points.end(), [&](const Point2& p) { return orient2d(from, to, p) < 0; }))
      return true;
  }
  return false;
}

// Tests for a separating line: two disjoint convex polygons in a plane are separated by an edge of one of
// them. A segment counts as a polygon with two edges.
bool intersect_in_plane(const Triangle3& t, std::span<const Point3> other) {
  PlaneView first(t);
  std::array<Point2, 3> projected;
  for (std::size_t k = 0; k < other.size(); ++k) projected[k] = project(other[k], first.axis);
  if (other.size() == 3 && orient2d(projected[0], projected[1], projected[2]) < 0)
    std::swap(projected[1], projected[2]);
  const std::span<const Point2> second(projected.data(), other.size());
  return !an_edge_separates(first.corners, second) && !an_edge_separates(second, first.corners);
}

// Returns whether a segment meets the triangle. Its ends lie on the sides `from_side` and `to_side` of the
// triangle's plane.
bool segment_meets(const Triangle3& t, const Point3& from, const Point3& to, int from_side, int to_side) {
  if (from_side == to_side) return from_side == 0 && intersect_in_plane(t, std::array{from, to});
  // The line crosses the plane within the triangle if it passes all edges on the same side.
  bool left = false, right = false;
  for (std::size_t k = 0; k < 3 && !(left && right); ++k) {
    const int side = orient3d(from, to, t[k], t[(k + 1) % 3]);
    left |= side > 0;
    right |= side < 0;
  }
  return !(left && right);
}

// Rotates the corners so that the one alone on its side of the other triangle's plane comes first. Both edges
// from that corner meet the plane. Returns its side, -1 or 1. A corner in the plane also counts as alone if
// the others lie on one side, and its side is then the opposite one.
int bring_apex_to_front(Triangle3& t, const Signs& sides) {
  const auto positive = std::count(sides.begin(), sides.end(), 1);
  const auto negative = std::count(sides.begin(), sides.end(), -1);
  const int apex = positive == 1 ? 1 : negative == 1 ? -1 : 0;
  const auto at = std::find(sides.begin(), sides.end(), apex);
  std::rotate(t.begin(), t.begin() + (at - sides.begin()), t.end());
  return apex != 0 ? apex : positive == 2 ? -1 : 1;
}

// Implements Guigue and Devillers 2003, section 3. The sides are those of each triangle's corners against the
// other's plane. Neither triangle lies strictly on one side, and they are not coplanar. Each triangle meets
// the line of the two planes in an interval: from the edge p₁q₁ to p₁r₁, and from p₂r₂ to p₂q₂. The intervals
// overlap if each begins before the end of the other.
bool intervals_overlap(Triangle3 a, Triangle3 b, const Signs& a_sides, const Signs& b_sides) {
  const int a_apex = bring_apex_to_front(a, a_sides), b_apex = bring_apex_to_front(b, b_sides);
  // Orients each triangle so that the apex of the other one is on its positive side.
  if (a_apex < 0) std::swap(b[1], b[2]);
  if (b_apex < 0) std::swap(a[1], a[2]);
  const auto& [p1, q1, r1] = a;
  const auto& [p2, q2, r2] = b;
  return orient3d(p1, q1, p2, q2) <= 0 && orient3d(p1, r1, r2, p2) <= 0;
}

// Returns whether p is certainly on the side of the plane through `origin` that the normal points to. The
// bound covers the rounding of three differences, three products and two sums, and underflow.
bool clearly_above(const Point3& origin, const Point3& normal, const Point3& p) {
  double height = 0, magnitude = 0;
  for (std::size_t k = 0; k < 3; ++k) {
    const double product = normal[k] * (p[k] - origin[k]);
    height += product;
    magnitude += std::abs(product);
  }
  return height > 8 * predicates::epsilon * magnitude + predicates::underflow;
}

// Returns whether two triangles certainly meet only in their first corner, which both have. The plane through
// it, perpendicular to the line between the midpoints of the opposite sides, must separate them. This settles
// most neighbours quickly.
bool clearly_part_at_first(const Triangle3& a, const Triangle3& b) {
  Point3 towards_a, towards_b;
  for (std::size_t k = 0; k < 3; ++k) {
    towards_a[k] = (a[1][k] + a[2][k]) - (b[1][k] + b[2][k]);
    towards_b[k] = -towards_a[k];
  }
  return clearly_above(a[0], towards_a, a[1]) && clearly_above(a[0], towards_a, a[2]) &&
         clearly_above(a[0], towards_b, b[1]) && clearly_above(a[0], towards_b, b[2]);
}

}  // namespace

bool has_area(const Triangle3& t) {
  for (const Point3& p : t)
    if (!std::isfinite(p[0]) || !std::isfinite(p[1]) || !std::isfinite(p[2])) return false;
  for (std::size_t axis = 0; axis < 3; ++axis)
    if (orient2d(project(t[0], axis), project(t[1], axis), project(t[2], axis)) != 0) return true;
  return false;
}

bool triangles_intersect(const Triangle3& a, const Triangle3& b) { return intersect_beyond_shared(a, b, 0); }

bool intersect_beyond_shared(const Triangle3& a, const Triangle3& b, int shared) {
  if (shared == 3) return false;
  if (shared == 1 && clearly_part_at_first(a, b)) return false;
  const auto first = static_cast<std::size_t>(shared);
  const Signs b_sides = plane_sides(a, b, first);
  if (strictly_on_one_side(b_sides, first)) return false;
  const Signs a_sides = plane_sides(b, a, first);
  if (strictly_on_one_side(a_sides, first)) return false;
  const bool coplanar = b_sides == Signs{};
  if (shared == 0) return coplanar ? intersect_in_plane(a, b) : intervals_overlap(a, b, a_sides, b_sides);
  // An intersection that begins in the common corner ends where the opposite side of one triangle meets the
  // other triangle.
  if (shared == 1)
    return segment_meets(a, b[1], b[2], b_sides[1], b_sides[2]) ||
           segment_meets(b, a[1], a[2], a_sides[1], a_sides[2]);
  // The triangles have a common edge and lie in one plane. They overlap if both are on the same side of the
  // edge.
  const PlaneView view(a);
  const auto turn = [&](const Point3& p) {
    return orient2d(project(a[0], view.axis), project(a[1], view.axis), project(p, view.axis));
  };
  return turn(a[2]) == turn(b[2]);
}

}  // namespace meshgraft
