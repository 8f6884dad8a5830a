#include "cap_region.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numeric>
#include <utility>

#include <Eigen/Geometry>

#include "core/sparse_checks.h"

namespace meshgraft {

namespace {

using OutlineEdge = std::array<Index, 2>;

std::vector<OutlineEdge> edges_of(const CapRegion& region) {
  std::vector<OutlineEdge> edges;
  const auto add = [&](const Outline& outline) {
    for (std::size_t k = 0; k < outline.size(); ++k)
      edges.push_back({outline[k], outline[(k + 1) % outline.size()]});
  };
  add(region.outer);
  for (const Outline& outline : region.inner) add(outline);
  return edges;
}

// Returns whether c, which is on the line of a and b, lies between them.
bool is_between(const Point2& a, const Point2& b, const Point2& c) {
  return std::min(a[0], b[0]) <= c[0] && c[0] <= std::max(a[0], b[0]) && std::min(a[1], b[1]) <= c[1] &&
         c[1] <= std::max(a[1], b[1]);
}

bool meet(const Point2& a, const Point2& b, const Point2& c, const Point2& d) {
  const int c_side = orient2d(a, b, c), d_side = orient2d(a, b, d);
  const int a_side = orient2d(c, d, a), b_side = orient2d(c, d, b);
  if (c_side * d_side < 0 && a_side * b_side < 0) return true;
  return (c_side == 0 && is_between(a, b, c)) || (d_side == 0 && is_between(a, b, d)) ||
         (a_side == 0 && is_between(c, d, a)) || (b_side == 0 && is_between(c, d, b));
}

// Segments that follow one another meet in one point, unless the second turns back onto the first.
bool overlap_after(const Point2& a, const Point2& middle, const Point2& b) {
  if (a == middle || b == middle) return true;
  if (orient2d(a, middle, b) != 0) return false;
  return (a[0] - middle[0]) * (b[0] - middle[0]) + (a[1] - middle[1]) * (b[1] - middle[1]) > 0;
}

bool edges_cross(std::span<const Point2> points, const OutlineEdge& s, const OutlineEdge& t) {
  if (s[1] == t[0]) return overlap_after(points[s[0]], points[s[1]], points[t[1]]);
  if (t[1] == s[0]) return overlap_after(points[t[0]], points[t[1]], points[s[1]]);
  return meet(points[s[0]], points[s[1]], points[t[0]], points[t[1]]);
}

bool is_inside(std::span<const Point2> points, const Outline& outline, const Point2& at) {
  bool inside = false;
  for (std::size_t k = 0; k < outline.size(); ++k) {
    const Point2 &a = points[outline[k]], &b = points[outline[(k + 1) % outline.size()]];
    if ((a[1] > at[1]) == (b[1] > at[1])) continue;
    if ((orient2d(a, b, at) > 0) == (b[1] > a[1])) inside = !inside;
  }
  return inside;
}

Point2 lowest(std::span<const Point2> points, const Outline& outline) {
  Point2 low = points[outline.front()];
  for (const Index k : outline) low = std::min(low, points[k]);
  return low;
}

double squared_distance(const Point2& a, const Point2& b, const Point2& at) {
  const double dx = b[0] - a[0], dy = b[1] - a[1], px = at[0] - a[0], py = at[1] - a[1];
  const double length = dx * dx + dy * dy;
  const double t = length > 0 ? std::clamp((px * dx + py * dy) / length, 0.0, 1.0) : 0;
  return (px - t * dx) * (px - t * dx) + (py - t * dy) * (py - t * dy);
}

}  // namespace

PlaneFrame::PlaneFrame(const Plane& plane) : origin(plane.point), normal(plane.normal.stableNormalized()) {
  u = normal.unitOrthogonal();
  v = normal.cross(u);
}

double signed_area(std::span<const Point2> points, const Outline& outline) {
  double twice = 0;
  const Point2& o = points[outline.front()];
  for (std::size_t k = 0; k < outline.size(); ++k) {
    const Point2 &a = points[outline[k]], &b = points[outline[(k + 1) % outline.size()]];
    twice += (a[0] - o[0]) * (b[1] - o[1]) - (a[1] - o[1]) * (b[0] - o[0]);
  }
  return twice / 2;
}

double area(std::span<const Point2> points, const CapRegion& region) {
  return std::accumulate(
      region.inner.begin(), region.inner.end(), signed_area(points, region.outer),
      [&](double sum, const Outline& outline) { return sum + signed_area(points, outline); });
}

std::vector<CapRegion> nest_outlines(std::span<const Point2> points, const std::vector<Outline>& outlines) {
  std::vector<CapRegion> regions;
  std::vector<const Outline*> holes;
  for (const Outline& outline : outlines) {
    if (signed_area(points, outline) > 0)
      regions.push_back({outline, {}});
    else
      holes.push_back(&outline);
  }
  std::sort(regions.begin(), regions.end(), [&](const CapRegion& a, const CapRegion& b) {
    return lowest(points, a.outer) < lowest(points, b.outer);
  });
  for (const Outline* hole : holes) {
    CapRegion* around = nullptr;
    double least = std::numeric_limits<double>::infinity();
    for (CapRegion& region : regions) {
      const double size = signed_area(points, region.outer);
      if (size >= least || !is_inside(points, region.outer, points[hole->front()])) continue;
      around = &region;
      least = size;
    }
    if (around == nullptr) return {};
    around->inner.push_back(*hole);
  }
  return regions;
}

std::optional<Point2> find_crossing(std::span<const Point2> points, const CapRegion& region,
                                    const Context& context) {
  std::vector<OutlineEdge> edges = edges_of(region);
  const auto left = [&](const OutlineEdge& s) { return std::min(points[s[0]][0], points[s[1]][0]); };
  const auto right = [&](const OutlineEdge& s) { return std::max(points[s[0]][0], points[s[1]][0]); };
  std::sort(edges.begin(), edges.end(), [&](const OutlineEdge& a, const OutlineEdge& b) {
    return std::pair(left(a), a) < std::pair(left(b), b);
  });
  SparseChecks check(context);
  for (std::size_t i = 0; i < edges.size(); ++i) {
    for (std::size_t j = i + 1; j < edges.size() && left(edges[j]) <= right(edges[i]); ++j) {
      check();
      if (edges_cross(points, edges[i], edges[j])) return points[edges[j][0]];
    }
  }
  return {};
}

double distance_within(std::span<const Point2> points, const CapRegion& region, const Point2& at) {
  bool inside = false;
  double least = std::numeric_limits<double>::infinity();
  const auto visit = [&](const Outline& outline) {
    for (std::size_t k = 0; k < outline.size(); ++k)
      least =
          std::min(least, squared_distance(points[outline[k]], points[outline[(k + 1) % outline.size()]], at));
    inside = inside != is_inside(points, outline, at);
  };
  visit(region.outer);
  for (const Outline& outline : region.inner) visit(outline);
  return inside ? std::sqrt(least) : -std::sqrt(least);
}

}  // namespace meshgraft
