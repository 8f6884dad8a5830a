#include <meshgraft/deform/intersections.h>

#include <algorithm>
#include <atomic>
#include <cstdint>
#include <utility>

#include <boost/geometry/core/cs.hpp>
#include <boost/geometry/geometries/box.hpp>
#include <boost/geometry/geometries/point.hpp>
#include <boost/geometry/index/rtree.hpp>

#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Intersections_3/Segment_3_Triangle_3.h>
#include <CGAL/Intersections_3/Triangle_3_Triangle_3.h>

#include <meshgraft/core/parallel.h>
#include <meshgraft/mesh/topology.h>

#include "free_vertices.h"

namespace meshgraft {

namespace {

using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
using Corners = std::array<Kernel::Point_3, 3>;

Kernel::Point_3 point(const Points& points, Index v) { return {points(v, 0), points(v, 1), points(v, 2)}; }

Corners corners(const Points& points, const std::array<Index, 3>& v) {
  return {point(points, v[0]), point(points, v[1]), point(points, v[2])};
}

std::array<Index, 3> vertices(const Triangles& triangles, Index t) {
  return {triangles(t, 0), triangles(t, 1), triangles(t, 2)};
}

bool has_area(const Points& points, const std::array<Index, 3>& v) {
  for (const Index vertex : v)
    if (!points.row(vertex).allFinite()) return false;
  const Corners c = corners(points, v);
  return !CGAL::collinear(c[0], c[1], c[2]);
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

// Whether the corners of `b` from `first` on lie strictly on one side of the plane of `a`.
bool on_one_side(const Corners& a, const Corners& b, int first) {
  const CGAL::Orientation side = CGAL::orientation(a[0], a[1], a[2], b[static_cast<std::size_t>(first)]);
  if (side == CGAL::COPLANAR) return false;
  return std::all_of(b.begin() + first, b.end(),
                     [&](const Kernel::Point_3& p) { return CGAL::orientation(a[0], a[1], a[2], p) == side; });
}

// Whether two triangles with area have more in common than the vertices and edges that they share.
bool intersect(const Points& points, std::array<Index, 3> v, std::array<Index, 3> w) {
  const int shared = match_shared(v, w);
  if (shared == 3) return false;
  const Corners a = corners(points, v), b = corners(points, w);
  if (on_one_side(a, b, shared) || on_one_side(b, a, shared)) return false;
  // Over a common edge the planes agree now, and the triangles overlap if both lie on its same side.
  if (shared == 2) return CGAL::coplanar_orientation(a[0], a[1], a[2], b[2]) == CGAL::POSITIVE;
  const Kernel::Triangle_3 first(a[0], a[1], a[2]), second(b[0], b[1], b[2]);
  if (shared == 0) return CGAL::do_intersect(first, second);
  // What begins in a common vertex ends where the side opposite of it, of one, meets the other.
  return CGAL::do_intersect(first, Kernel::Segment_3(b[1], b[2])) ||
         CGAL::do_intersect(second, Kernel::Segment_3(a[1], a[2]));
}

namespace geometry = boost::geometry;
using BoxPoint = geometry::model::point<double, 3, geometry::cs::cartesian>;
using Box = geometry::model::box<BoxPoint>;
using BoxedTriangle = std::pair<Box, Index>;
using BoxTree = geometry::index::rtree<BoxedTriangle, geometry::index::linear<16>>;

Box bounding_box(const Points& points, const std::array<Index, 3>& v) {
  const auto a = points.row(v[0]), b = points.row(v[1]), c = points.row(v[2]);
  const Eigen::RowVector3d low = a.cwiseMin(b).cwiseMin(c), high = a.cwiseMax(b).cwiseMax(c);
  return {{low[0], low[1], low[2]}, {high[0], high[1], high[2]}};
}

struct Surface {
  std::vector<BoxedTriangle> free;    // triangles with area that touch a free vertex
  std::vector<BoxedTriangle> others;  // and those that do not, near them
  std::vector<char> is_free;          // per triangle: in `free`
};

Surface sort_triangles(const Points& points, const Triangles& triangles, std::span<const Index> free_vertices,
                       const Context& context) {
  const auto count = static_cast<std::size_t>(triangles.rows());
  const std::vector<char> vertex_is_free = flag_free(points.rows(), free_vertices);
  const IndexLists faces_around = vertex_triangles(static_cast<Index>(points.rows()), triangles, context);
  std::vector<char> area(count, 0);
  parallel_blocks(
      count,
      [&](std::size_t begin, std::size_t end) {
        for (std::size_t t = begin; t < end; ++t)
          area[t] = has_area(points, vertices(triangles, static_cast<Index>(t)));
      },
      context);

  Surface surface;
  surface.is_free.assign(count, 0);
  for (const Index v : free_vertices)
    for (const Index t : faces_around[v]) surface.is_free[t] = area[t];
  Box reach;
  geometry::assign_inverse(reach);
  const auto boxed = [&](Index t) { return BoxedTriangle(bounding_box(points, vertices(triangles, t)), t); };
  for (Index t = 0; t < triangles.rows(); ++t) {
    if (!surface.is_free[t]) continue;
    surface.free.push_back(boxed(t));
    geometry::expand(reach, surface.free.back().first);
  }
  for (Index t = 0; t < triangles.rows(); ++t) {
    if (surface.is_free[t] || !area[t]) continue;
    const BoxedTriangle other = boxed(t);
    if (geometry::intersects(other.first, reach)) surface.others.push_back(other);
  }
  return surface;
}

}  // namespace

std::optional<std::vector<TrianglePair>> self_intersections(const Points& points, const Triangles& triangles,
                                                            std::span<const Index> free_vertices,
                                                            const Context& context) {
  const Surface surface = sort_triangles(points, triangles, free_vertices, context);
  std::vector<BoxedTriangle> boxes = surface.others;
  boxes.insert(boxes.end(), surface.free.begin(), surface.free.end());
  const BoxTree tree(boxes);

  std::vector<std::vector<TrianglePair>> found(surface.free.size());
  // Only whether the sum exceeds the limit matters, and that does not depend on the order.
  std::atomic<std::int64_t> candidates{0};
  parallel_blocks(
      found.size(),
      [&](std::size_t begin, std::size_t end) {
        std::vector<BoxedTriangle> near;
        for (std::size_t k = begin; k < end && candidates <= max_intersection_candidates; ++k) {
          const auto& [box, t] = surface.free[k];
          near.clear();
          tree.query(geometry::index::intersects(box), std::back_inserter(near));
          candidates += static_cast<std::int64_t>(near.size());
          for (const auto& [other_box, other] : near) {
            if (surface.is_free[other] && other <= t) continue;  // that pair is found from the other triangle
            if (intersect(points, vertices(triangles, t), vertices(triangles, other)))
              found[k].push_back({std::min(t, other), std::max(t, other)});
          }
        }
      },
      context, 128);
  if (candidates > max_intersection_candidates) return std::nullopt;

  std::vector<TrianglePair> pairs;
  for (const auto& some : found) pairs.insert(pairs.end(), some.begin(), some.end());
  std::sort(pairs.begin(), pairs.end());
  return pairs;
}

std::optional<std::vector<TrianglePair>> new_self_intersections(const Points& rest, const Points& edited,
                                                                const Triangles& triangles,
                                                                std::span<const Index> free_vertices,
                                                                const Context& context) {
  require_same_vertices(rest, edited);
  std::optional<std::vector<TrianglePair>> pairs =
      self_intersections(edited, triangles, free_vertices, context);
  if (!pairs) return pairs;
  std::vector<char> old(pairs->size(), 0);
  parallel_blocks(
      old.size(),
      [&](std::size_t begin, std::size_t end) {
        for (std::size_t k = begin; k < end; ++k) {
          const auto v = vertices(triangles, (*pairs)[k][0]), w = vertices(triangles, (*pairs)[k][1]);
          old[k] = has_area(rest, v) && has_area(rest, w) && intersect(rest, v, w);
        }
      },
      context);
  std::size_t k = 0;
  std::erase_if(*pairs, [&](const TrianglePair&) { return old[k++] != 0; });
  return pairs;
}

}  // namespace meshgraft
