#include "intrinsic_delaunay.h"

#include <algorithm>
#include <cmath>
#include <compare>
#include <numeric>
#include <span>

#include <Eigen/Geometry>

#include "core/sparse_checks.h"

namespace meshgraft {

namespace {

/// Bounds of the weights. Every edge connects, and needles do not spoil the conditioning. Right-angled
/// triangles of 1:16 reach the larger bound.
constexpr double smallest_weight = 1e-3, largest_weight = 16;

/// A half-edge, at its smaller end.
struct HalfEdgeAt {
  Index larger_end, half_edge;
  friend auto operator<=>(const HalfEdgeAt&, const HalfEdgeAt&) = default;
};

/// Calls `body(vertex, half_edges)` for each vertex, ascending, with the half-edges whose smaller end it is.
/// They ascend, so that those of one edge are neighbours.
template <class Triangulation, class Body>
void visit_half_edges(const Triangulation& surface, Index vertex_count, const Body& body) {
  const auto smaller_end = [&](Index h) { return std::min(surface.start(h), surface.end(h)); };
  std::vector<Index> begin(static_cast<std::size_t>(vertex_count) + 1, 0);
  for (Index h = 0; h < surface.half_edges(); ++h) ++begin[smaller_end(h) + 1];
  std::partial_sum(begin.begin(), begin.end(), begin.begin());
  std::vector<HalfEdgeAt> sorted(surface.half_edges());
  std::vector<Index> next(begin.begin(), begin.end() - 1);
  for (Index h = 0; h < surface.half_edges(); ++h)
    sorted[next[smaller_end(h)]++] = {std::max(surface.start(h), surface.end(h)), h};
  for (Index v = 0; v < vertex_count; ++v) {
    std::sort(sorted.begin() + begin[v], sorted.begin() + begin[v + 1]);
    body(v, std::span<const HalfEdgeAt>(sorted.data() + begin[v], sorted.data() + begin[v + 1]));
  }
}

/// A triangulation with lengths instead of positions. Half-edge 3t+k runs from corner k of triangle t to the
/// next corner.
class IntrinsicTriangulation {
 public:
  IntrinsicTriangulation(const Points& points, const Triangles& triangles) {
    for (const auto& t : triangles.rowwise())
      if (t[0] != t[1] && t[1] != t[2] && t[2] != t[0]) start_.insert(start_.end(), {t[0], t[1], t[2]});
    length_.resize(start_.size());
    for (Index h = 0; h < half_edges(); ++h) length_[h] = (points.row(end(h)) - points.row(start_[h])).norm();
    find_twins(static_cast<Index>(points.rows()));
    measure(points);
  }

  Index half_edges() const { return static_cast<Index>(start_.size()); }
  Index start(Index h) const { return start_[h]; }
  Index end(Index h) const { return start_[next(h)]; }
  bool mollified() const { return mollified_; }

  /// Flips edges until all are Delaunay. Returns the number of flips.
  std::size_t flip_to_delaunay(const Context& context) {
    std::vector<Index> stack;
    for (Index h = 0; h < half_edges(); ++h)
      if (h < twin_[h] && !is_delaunay(h)) stack.push_back(h);
    SparseChecks check(context);
    const std::size_t most_flips = 10 * start_.size();
    std::size_t flips = 0;
    while (!stack.empty() && flips < most_flips) {
      check();
      const Index h = stack.back();  // a flip may have made it another edge, at a boundary, too
      stack.pop_back();
      if (twin_[h] < 0 || is_delaunay(h) || !flip(h)) continue;
      ++flips;
      const Index g = twin_[h];
      for (const Index side : {next(h), next(next(h)), next(g), next(next(g))})
        if (twin_[side] >= 0) stack.push_back(side);
    }
    return flips;
  }

  /// Returns the cotangent of the angle opposite a half-edge.
  double cotangent(Index h) const { return cotangent_[h]; }

 private:
  static Index next(Index h) { return h % 3 == 2 ? h - 2 : h + 1; }

  void find_twins(Index vertex_count) {
    twin_.assign(start_.size(), -1);
    visit_half_edges(*this, vertex_count, [&](Index, std::span<const HalfEdgeAt> at) {
      for (std::size_t first = 0, last = 0; first < at.size(); first = last) {
        while (last < at.size() && at[last].larger_end == at[first].larger_end) ++last;
        const Index h = at[first].half_edge, g = at[last - 1].half_edge;
        if (last - first != 2 || start(h) == start(g)) continue;
        twin_[h] = g;
        twin_[g] = h;
      }
    });
  }

  /// Computes the cotangents. Those of triangles that need no mollification come from positions, because
  /// lengths alone lose the digits of a needle's angles.
  void measure(const Points& points) {
    const double margin = mollification_margin();
    double shortfall = 0;
    for (Index h = 0; h < half_edges(); ++h) shortfall = std::max(shortfall, margin - slack(h));
    cotangent_.resize(start_.size());
    for (Index t = 0; t < half_edges(); t += 3) {
      const bool is_valid = std::min({slack(t), slack(t + 1), slack(t + 2)}) >= margin;
      for (Index h = t; h < t + 3; ++h) {
        length_[h] += shortfall;
        if (!is_valid) continue;
        const Eigen::RowVector3d apex = points.row(start_[next(next(h))]);
        const Eigen::RowVector3d a = points.row(start_[h]) - apex, b = points.row(end(h)) - apex;
        cotangent_[h] = a.dot(b) / a.cross(b).norm();
      }
      if (!is_valid) measure_by_lengths(t);
    }
    mollified_ = shortfall > 0;
  }

  double mollification_margin() const {
    constexpr double margin_rel = 1e-5;
    double mean = 0;
    for (const double length : length_) mean += length / static_cast<double>(length_.size());
    return margin_rel * mean;
  }

  /// Computes the cotangents of a triangle from its lengths, with the area by Heron's formula in Kahan's form.
  void measure_by_lengths(Index t) {
    std::array<double, 3> sides{length_[t], length_[t + 1], length_[t + 2]};
    std::sort(sides.begin(), sides.end());
    const auto [c, b, a] = sides;
    const double area4 =
        std::sqrt(std::max((a + (b + c)) * (c - (a - b)) * (c + (a - b)) * (a + (b - c)), 0.0));
    for (Index h = t; h < t + 3; ++h) {
      const double across = length_[h], left = length_[next(h)], right = length_[next(next(h))];
      cotangent_[h] = (left * left + right * right - across * across) / area4;
    }
  }

  /// Returns by how much the two other sides are longer than a half-edge.
  double slack(Index h) const { return length_[next(h)] + length_[next(next(h))] - length_[h]; }

  bool is_delaunay(Index h) const {
    constexpr double rounding = 1e-9;
    return cotangent_[h] + cotangent_[twin_[h]] >= -rounding;
  }

  /// Replaces the edge between two triangles by the other diagonal of their quad.
  bool flip(Index h) {
    const Index g = twin_[h], hn = next(h), hp = next(hn), gn = next(g), gp = next(gn);
    if (h / 3 == g / 3) return false;
    // The triangles are a b c and b a d; c d replaces a b. In the plane a is at 0 and b at (l, 0).
    const double l = length_[h], bc = length_[hn], ca = length_[hp], ad = length_[gn], db = length_[gp];
    using Vector = Eigen::Vector2d;
    const Vector at_a(0, 0), at_b(l, 0),
        at_c = l / (cotangent_[hn] + cotangent_[hp]) * Vector(cotangent_[hn], 1),
        at_d = l / (cotangent_[gp] + cotangent_[gn]) * Vector(cotangent_[gp], -1);
    const double cd = (at_c - at_d).norm();
    const Index c = start_[hp], d = start_[gp];
    struct Side {
      double length;
      Index twin, self;
    };
    const Side side_bc{bc, twin_[hn], hn}, side_ca{ca, twin_[hp], hp}, side_ad{ad, twin_[gn], gn},
        side_db{db, twin_[gp], gp};
    const Index a = start_[h], b = start_[g];
    // h becomes c d in the triangle c d b, g becomes d c in d c a.
    start_[h] = c, start_[hn] = d, start_[hp] = b;
    start_[g] = d, start_[gn] = c, start_[gp] = a;
    length_[h] = length_[g] = cd;
    const std::array<std::pair<Index, Side>, 4> moved{
        {{hn, side_db}, {hp, side_bc}, {gn, side_ca}, {gp, side_ad}}};
    const auto now_at = [&](Index old) {
      for (const auto& [to, side] : moved)
        if (side.self == old) return to;
      return old;
    };
    for (const auto& [to, side] : moved) {
      length_[to] = side.length;
      twin_[to] = side.twin < 0 ? -1 : now_at(side.twin);
      if (side.twin >= 0) twin_[twin_[to]] = to;
    }
    const auto cotangent_between = [](const Vector& u, const Vector& v) {
      return u.dot(v) / std::abs(u.x() * v.y() - u.y() * v.x());
    };
    cotangent_[h] = cotangent_between(at_c - at_b, at_d - at_b);
    cotangent_[hn] = cotangent_between(at_d - at_c, at_b - at_c);
    cotangent_[hp] = cotangent_between(at_b - at_d, at_c - at_d);
    cotangent_[g] = cotangent_between(at_d - at_a, at_c - at_a);
    cotangent_[gn] = cotangent_between(at_c - at_d, at_a - at_d);
    cotangent_[gp] = cotangent_between(at_a - at_c, at_d - at_c);
    return true;
  }

  std::vector<Index> start_, twin_;         // per half-edge
  std::vector<double> length_, cotangent_;  // cotangent of the opposite angle
  bool mollified_ = false;
};

}  // namespace

IntrinsicEdges intrinsic_delaunay_edges(const Points& points, const Triangles& triangles,
                                        const Context& context) {
  context.throw_if_stopped();
  IntrinsicTriangulation surface(points, triangles);
  context.throw_if_stopped();
  IntrinsicEdges result;
  result.differ = surface.flip_to_delaunay(context) > 0 || surface.mollified();
  context.throw_if_stopped();
  result.edges.reserve(surface.half_edges() / 2 + surface.half_edges() / 16);
  const auto add_edges = [&](Index v, std::span<const HalfEdgeAt> half_edges) {
    for (const auto& [larger_end, h] : half_edges) {
      if (larger_end == v) continue;
      if (result.edges.empty() || result.edges.back().ends != std::array{v, larger_end})
        result.edges.push_back({{v, larger_end}, 0});
      result.edges.back().weight += surface.cotangent(h) / 2;
    }
  };
  visit_half_edges(surface, static_cast<Index>(points.rows()), add_edges);
  for (CotangentEdge& edge : result.edges)
    edge.weight = std::clamp(edge.weight, smallest_weight, largest_weight);
  return result;
}

SparseRows dirichlet_matrix(Index vertex_count, const IntrinsicEdges& surface) {
  std::vector<int> lengths(vertex_count, 0);
  for (const CotangentEdge& edge : surface.edges)
    for (const Index v : edge.ends) ++lengths[v];
  for (int& length : lengths) length += length > 0;
  SparseRows K = rows_of_lengths(lengths, vertex_count);
  std::vector<int> next(K.outerIndexPtr(), K.outerIndexPtr() + vertex_count);
  const auto append = [&](Index row, Index column, double value) {
    K.innerIndexPtr()[next[row]] = column;
    K.valuePtr()[next[row]++] = value;
  };
  // Edges ascend, so that a row first gets its entries left of the diagonal.
  std::vector<double> sums(vertex_count, 0.0);
  for (const auto& [ends, weight] : surface.edges)
    for (const Index v : ends) sums[v] += weight;
  for (const auto& [ends, weight] : surface.edges) append(ends[1], ends[0], -weight);
  for (Index v = 0; v < vertex_count; ++v)
    if (lengths[v] > 0) append(v, v, sums[v]);
  for (const auto& [ends, weight] : surface.edges) append(ends[0], ends[1], -weight);
  return K;
}

}  // namespace meshgraft
