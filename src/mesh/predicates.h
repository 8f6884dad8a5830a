#pragma once

#include <array>
#include <cmath>

namespace meshgraft {

using Point2 = std::array<double, 2>;
using Point3 = std::array<double, 3>;

/// Return the same signs as `orient2d` and `orient3d` below, in integers, for cases that the filters leave
/// undecided. The coordinate differences usually fit into 62 bits; then their determinant is an integer of
/// 192 bits. Otherwise the two functions that follow decide.
int exact_orient2d(const Point2& a, const Point2& b, const Point2& c);
int exact_orient3d(const Point3& a, const Point3& b, const Point3& c, const Point3& d);

/// Return the same signs for all finite coordinates. The determinant is a sum of products of coordinates, in
/// fixed point over the exponents that occur, up to 6300 bits.
int fixed_point_orient2d(const Point2& a, const Point2& b, const Point2& c);
int fixed_point_orient3d(const Point3& a, const Point3& b, const Point3& c, const Point3& d);

namespace predicates {

/// Half an ulp of 1.
inline constexpr double epsilon = 0x1p-53;
/// Bounds the loss of a product to underflow, and is itself far from underflow.
inline constexpr double underflow = 0x1p-1000;

}  // namespace predicates

/// Returns the sign (-1, 0, 1) of det [b − a, c − a]: 1 if a, b, c turn to the left. Exact for all finite
/// coordinates. Filter: Shewchuk 1997, "Adaptive precision floating-point arithmetic and fast robust
/// geometric predicates", ccwerrboundA = (3 + 16ε)ε, here rounded up and with a term for underflow. If a
/// product overflows, the bound is infinite or not a number, and the filter decides nothing.
inline int orient2d(const Point2& a, const Point2& b, const Point2& c) {
  const double left = (b[0] - a[0]) * (c[1] - a[1]);
  const double right = (b[1] - a[1]) * (c[0] - a[0]);
  const double bound = 4 * predicates::epsilon * (std::abs(left) + std::abs(right)) + predicates::underflow;
  const double determinant = left - right;
  if (determinant > bound) return 1;
  if (-determinant > bound) return -1;
  return exact_orient2d(a, b, c);
}

/// Returns the sign (-1, 0, 1) of det [b − a, c − a, d − a]: 1 if d lies on the side of the plane abc from
/// which a, b, c appear counter-clockwise, 0 if the four are coplanar. Exact for all finite coordinates.
/// Filter: Shewchuk 1997, o3derrboundA = (7 + 56ε)ε, with the same additions as in `orient2d`.
inline int orient3d(const Point3& a, const Point3& b, const Point3& c, const Point3& d) {
  const double ux = b[0] - a[0], uy = b[1] - a[1], uz = b[2] - a[2];
  const double vx = c[0] - a[0], vy = c[1] - a[1], vz = c[2] - a[2];
  const double wx = d[0] - a[0], wy = d[1] - a[1], wz = d[2] - a[2];
  const double uyvz = uy * vz, uzvy = uz * vy, uzvx = uz * vx, uxvz = ux * vz, uxvy = ux * vy, uyvx = uy * vx;
  const double x = std::abs(wx), y = std::abs(wy), z = std::abs(wz);
  const double permanent = (std::abs(uyvz) + std::abs(uzvy)) * x + (std::abs(uzvx) + std::abs(uxvz)) * y +
                           (std::abs(uxvy) + std::abs(uyvx)) * z;
  const double bound = 8 * predicates::epsilon * permanent + predicates::underflow * (1 + x + y + z);
  const double determinant = (uyvz - uzvy) * wx + (uzvx - uxvz) * wy + (uxvy - uyvx) * wz;
  if (determinant > bound) return 1;
  if (-determinant > bound) return -1;
  return exact_orient3d(a, b, c, d);
}

}  // namespace meshgraft
