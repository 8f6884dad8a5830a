#include "region_triangulation.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numeric>
#include <queue>
#include <unordered_map>
#include <utility>

#include "core/sparse_checks.h"

namespace meshgraft {

namespace {

using Triangle = std::array<Index, 3>;

double squared_length(const Point2& a, const Point2& b) {
  return (b[0] - a[0]) * (b[0] - a[0]) + (b[1] - a[1]) * (b[1] - a[1]);
}

double turn(const Point2& a, const Point2& b, const Point2& c) {
  return (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]);
}

// Joins inner outlines with the outer one (Eberly, "Triangulation by ear clipping"). The one that reaches
// farthest to the right comes first, because what is right of it is joined already.
class Bridges {
 public:
  Bridges(std::span<const Point2> points, const CapRegion& region, const Context& context)
      : points_(points), context_(context), polygon_(region.outer), left_(region.inner) {
    std::sort(left_.begin(), left_.end(), [&](const Outline& a, const Outline& b) {
      return points_[a[rightmost(a)]] < points_[b[rightmost(b)]];
    });
  }

  Outline join() {
    while (!left_.empty()) {
      const Outline& inner = left_.back();
      const auto start = static_cast<std::ptrdiff_t>(rightmost(inner));
      const auto end = static_cast<std::ptrdiff_t>(visible_from(inner[start]));
      Outline joined(polygon_.begin(), polygon_.begin() + end + 1);
      joined.insert(joined.end(), inner.begin() + start, inner.end());
      joined.insert(joined.end(), inner.begin(), inner.begin() + start + 1);
      joined.insert(joined.end(), polygon_.begin() + end, polygon_.end());
      polygon_ = std::move(joined);
      left_.pop_back();
    }
    return polygon_;
  }

 private:
  std::size_t rightmost(const Outline& outline) const {
    return static_cast<std::size_t>(
        std::max_element(outline.begin(), outline.end(),
                         [&](Index a, Index b) { return points_[a] < points_[b]; }) -
        outline.begin());
  }

  // Returns the position in the polygon of the nearest point that the bridge from `from` reaches.
  std::size_t visible_from(Index from) const {
    std::vector<std::size_t> order(polygon_.size());
    std::iota(order.begin(), order.end(), std::size_t{0});
    std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
      return squared_length(points_[from], points_[polygon_[a]]) <
             squared_length(points_[from], points_[polygon_[b]]);
    });
    SparseChecks check(context_);
    for (const std::size_t end : order) {
      check();
      if (opens_towards(end, from) && !is_blocked(from, polygon_[end])) return end;
    }
    return order.front();  // not reached for outlines that do not cross
  }

  // Returns whether the polygon's inner angle at one of its corners contains the direction to a point.
  bool opens_towards(std::size_t corner, Index to) const {
    const Point2& before = points_[polygon_[(corner + polygon_.size() - 1) % polygon_.size()]];
    const Point2 &here = points_[polygon_[corner]], &after = points_[polygon_[(corner + 1) % polygon_.size()]];
    const bool left_of_first = orient2d(before, here, points_[to]) > 0;
    const bool left_of_second = orient2d(here, after, points_[to]) > 0;
    return orient2d(before, here, after) >= 0 ? left_of_first && left_of_second
                                              : left_of_first || left_of_second;
  }

  bool is_blocked(Index from, Index to) const {
    const auto blocks = [&](const Outline& outline) {
      for (std::size_t k = 0; k < outline.size(); ++k)
        if (blocked_by(from, to, outline[k], outline[(k + 1) % outline.size()])) return true;
      return false;
    };
    return blocks(polygon_) || std::any_of(left_.begin(), left_.end(), blocks);
  }

  // Returns whether the bridge meets an edge elsewhere than at a common end.
  bool blocked_by(Index from, Index to, Index a, Index b) const {
    const Point2 &p = points_[from], &q = points_[to], &r = points_[a], &s = points_[b];
    if (std::max(p[0], q[0]) < std::min(r[0], s[0]) || std::max(r[0], s[0]) < std::min(p[0], q[0]) ||
        std::max(p[1], q[1]) < std::min(r[1], s[1]) || std::max(r[1], s[1]) < std::min(p[1], q[1]))
      return false;
    const auto lies_on_bridge = [&](Index k) {
      return k != from && k != to && orient2d(p, q, points_[k]) == 0 && std::min(p, q) <= points_[k] &&
             points_[k] <= std::max(p, q);
    };
    if (lies_on_bridge(a) || lies_on_bridge(b)) return true;
    if (a == from || a == to || b == from || b == to) return false;
    return orient2d(p, q, r) * orient2d(p, q, s) < 0 && orient2d(r, s, p) * orient2d(r, s, q) < 0;
  }

  std::span<const Point2> points_;
  const Context& context_;
  Outline polygon_;
  std::vector<Outline> left_;
};

// Clips ears, the best-shaped first. An ear is left of its edges, and no other corner lies in it.
class ExactEars {
 public:
  ExactEars(std::span<const Point2> points, const Outline& polygon, const Context& context)
      : points_(points), polygon_(polygon), check_(context), before_(polygon.size()), after_(polygon.size()) {
    const auto n = static_cast<Index>(polygon.size());
    for (Index c = 0; c < n; ++c) {
      before_[c] = (c + n - 1) % n;
      after_[c] = (c + 1) % n;
      corners_.push_back(c);
    }
    quality_.assign(polygon.size(), 0);
    rate_all();
  }

  std::vector<Triangle> clip() {
    std::vector<Triangle> triangles;
    std::size_t left = polygon_.size();
    while (left >= 3) {
      if (ears_.empty()) rate_all();
      if (ears_.empty()) break;  // not reached for outlines that do not cross
      const auto [quality, minus_corner] = ears_.top();
      ears_.pop();
      const Index ear = -minus_corner;
      if (after_[ear] < 0 || quality_[ear] != quality) continue;
      const Index a = before_[ear], b = after_[ear];
      triangles.push_back({polygon_[a], polygon_[ear], polygon_[b]});
      after_[a] = b;
      before_[b] = a;
      after_[ear] = -1;
      if (--left < 3) break;
      if (2 * left < corners_.size()) std::erase_if(corners_, [&](Index c) { return after_[c] < 0; });
      rate(a);
      rate(b);
    }
    return triangles;
  }

 private:
  const Point2& at(Index corner) const { return points_[polygon_[corner]]; }

  void rate_all() {
    for (const Index c : corners_)
      if (after_[c] >= 0) rate(c);
  }

  void rate(Index c) {
    check_();
    const Point2 &a = at(before_[c]), &b = at(c), &d = at(after_[c]);
    quality_[c] = 0;
    if (orient2d(a, b, d) <= 0 || is_covered(c)) return;
    const double longest = std::max({squared_length(a, b), squared_length(b, d), squared_length(d, a)});
    quality_[c] = std::max(turn(a, b, d) / longest, 1e-300);
    ears_.emplace(quality_[c], -c);
  }

  bool is_covered(Index c) const {
    const Point2 &a = at(before_[c]), &b = at(c), &d = at(after_[c]);
    const double low_x = std::min({a[0], b[0], d[0]}), high_x = std::max({a[0], b[0], d[0]});
    const double low_y = std::min({a[1], b[1], d[1]}), high_y = std::max({a[1], b[1], d[1]});
    return std::any_of(corners_.begin(), corners_.end(), [&](Index other) {
      const Point2& q = at(other);
      if (after_[other] < 0 || q[0] < low_x || q[0] > high_x || q[1] < low_y || q[1] > high_y) return false;
      if (q == a || q == b || q == d) return false;
      return orient2d(a, b, q) >= 0 && orient2d(b, d, q) >= 0 && orient2d(d, a, q) >= 0;
    });
  }

  std::span<const Point2> points_;
  const Outline& polygon_;
  SparseChecks check_;
  std::vector<Index> before_, after_, corners_;  // `after_` is -1 at clipped corners
  std::vector<double> quality_;
  std::priority_queue<std::pair<double, Index>> ears_;  // stale where the quality has changed since
};

// Flips edges whose opposite angles sum up to more than π, if both new triangles turn left.
class PlaneFlips {
 public:
  PlaneFlips(std::span<const Point2> points, std::vector<Triangle>& triangles)
      : points_(points), triangles_(triangles) {
    for (Index t = 0; t < static_cast<Index>(triangles_.size()); ++t) enter(t);
  }

  void run() {
    std::vector<std::array<Index, 2>> stack;
    for (const Triangle& t : triangles_)
      for (std::size_t k = 0; k < 3; ++k) stack.push_back({t[k], t[(k + 1) % 3]});
    std::size_t most = 20 * stack.size() + 100;
    while (!stack.empty() && most-- > 0) {
      const auto [a, b] = stack.back();
      stack.pop_back();
      flip(a, b, stack);
    }
  }

 private:
  static std::uint64_t key(Index a, Index b) {
    return static_cast<std::uint64_t>(static_cast<std::uint32_t>(a)) << 32 | static_cast<std::uint32_t>(b);
  }

  void enter(Index t) {
    for (std::size_t k = 0; k < 3; ++k) at_edge_[key(triangles_[t][k], triangles_[t][(k + 1) % 3])] = t;
  }

  Index apex(Index t, Index a, Index b) const {
    for (const Index v : triangles_[t])
      if (v != a && v != b) return v;
    return -1;
  }

  double cotangent(Index at, Index a, Index b) const {
    const Point2 &o = points_[at], &p = points_[a], &q = points_[b];
    const double dot = (p[0] - o[0]) * (q[0] - o[0]) + (p[1] - o[1]) * (q[1] - o[1]);
    return dot / turn(o, p, q);
  }

  void flip(Index a, Index b, std::vector<std::array<Index, 2>>& stack) {
    const auto one = at_edge_.find(key(a, b)), other = at_edge_.find(key(b, a));
    if (one == at_edge_.end() || other == at_edge_.end()) return;
    const Index s = one->second, t = other->second;
    const Index c = apex(s, a, b), d = apex(t, a, b);
    if (c < 0 || d < 0 || c == d || at_edge_.contains(key(c, d)) || at_edge_.contains(key(d, c))) return;
    const double sum = cotangent(c, a, b) + cotangent(d, b, a);
    if (!(sum < -1e-9)) return;
    if (orient2d(points_[a], points_[d], points_[c]) <= 0 || orient2d(points_[d], points_[b], points_[c]) <= 0)
      return;
    at_edge_.erase(key(a, b));
    at_edge_.erase(key(b, a));
    triangles_[s] = {a, d, c};
    triangles_[t] = {d, b, c};
    enter(s);
    enter(t);
    stack.insert(stack.end(), {{a, d}, {d, b}, {b, c}, {c, a}});
  }

  std::span<const Point2> points_;
  std::vector<Triangle>& triangles_;
  std::unordered_map<std::uint64_t, Index> at_edge_;  // per directed edge: its triangle
};

}  // namespace

std::vector<std::array<Index, 3>> triangulate_region(std::span<const Point2> points, const CapRegion& region,
                                                     const Context& context) {
  const Outline polygon = Bridges(points, region, context).join();
  std::vector<Triangle> triangles = ExactEars(points, polygon, context).clip();
  PlaneFlips(points, triangles).run();
  return triangles;
}

}  // namespace meshgraft
