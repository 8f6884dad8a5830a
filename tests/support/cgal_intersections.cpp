#include "cgal_intersections.h"

#include <algorithm>
#include <cstddef>
#include <utility>

#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Intersections_3/Segment_3_Triangle_3.h>
#include <CGAL/Intersections_3/Triangle_3_Triangle_3.h>

namespace meshgraft::test {

namespace {

using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
using CgalPoints = std::array<Kernel::Point_3, 3>;

CgalPoints converted(const Corners& t) {
  const auto point = [](const std::array<double, 3>& p) { return Kernel::Point_3(p[0], p[1], p[2]); };
  return {point(t[0]), point(t[1]), point(t[2])};
}

// Returns whether the corners of `b` from `first` on lie strictly on one side of the plane of `a`.
bool on_one_side(const CgalPoints& a, const CgalPoints& b, int first) {
  const CGAL::Orientation side = CGAL::orientation(a[0], a[1], a[2], b[static_cast<std::size_t>(first)]);
  if (side == CGAL::COPLANAR) return false;
  return std::all_of(b.begin() + first, b.end(),
                     [&](const Kernel::Point_3& p) { return CGAL::orientation(a[0], a[1], a[2], p) == side; });
}

// Brings the vertices that both triangles have to the front of both, and returns how many there are.
int match_shared(std::array<Index, 3>& a, std::array<Index, 3>& b) {
  std::size_t shared = 0;
  for (std::size_t i = 0; i < 3; ++i) {
    const auto same = std::find(b.begin() + static_cast<std::ptrdiff_t>(shared), b.end(), a[i]);
    if (same == b.end()) continue;
    std::swap(a[shared], a[i]);
    std::swap(b[shared], *same);
    ++shared;
  }
  return static_cast<int>(shared);
}

}  // namespace

bool cgal_has_area(const Corners& t) {
  const CgalPoints p = converted(t);
  return !CGAL::collinear(p[0], p[1], p[2]);
}

bool cgal_intersect(const Corners& first, const Corners& second, int shared) {
  if (shared == 3) return false;
  const CgalPoints a = converted(first), b = converted(second);
  if (on_one_side(a, b, shared) || on_one_side(b, a, shared)) return false;
  if (shared == 2) return CGAL::coplanar_orientation(a[0], a[1], a[2], b[2]) == CGAL::POSITIVE;
  const Kernel::Triangle_3 s(a[0], a[1], a[2]), t(b[0], b[1], b[2]);
  if (shared == 0) return CGAL::do_intersect(s, t);
  return CGAL::do_intersect(s, Kernel::Segment_3(b[1], b[2])) ||
         CGAL::do_intersect(t, Kernel::Segment_3(a[1], a[2]));
}

std::vector<std::array<Index, 2>> cgal_self_intersections(const Points& points, const Triangles& triangles) {
  const auto vertices = [&](Index t) {
    return std::array<Index, 3>{triangles(t, 0), triangles(t, 1), triangles(t, 2)};
  };
  const auto corners = [&](const std::array<Index, 3>& v) {
    Corners c;
    for (std::size_t k = 0; k < 3; ++k) c[k] = {points(v[k], 0), points(v[k], 1), points(v[k], 2)};
    return c;
  };
  std::vector<Index> with_area;
  for (Index t = 0; t < triangles.rows(); ++t)
    if (cgal_has_area(corners(vertices(t)))) with_area.push_back(t);
  std::vector<std::array<Index, 2>> pairs;
  for (std::size_t i = 0; i < with_area.size(); ++i)
    for (std::size_t j = i + 1; j < with_area.size(); ++j) {
      auto v = vertices(with_area[i]), w = vertices(with_area[j]);
      const int shared = match_shared(v, w);
      if (cgal_intersect(corners(v), corners(w), shared)) pairs.push_back({with_area[i], with_area[j]});
    }
  return pairs;
}

}  // namespace meshgraft::test
