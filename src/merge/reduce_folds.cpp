#include "reduce_folds.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include <Eigen/Geometry>

namespace meshgraft {

namespace {

using Eigen::Vector3d;

// The cost of the edges and triangles of a patch, as a function of its vertex positions.
class Cost {
 public:
  Cost(const Points& points, const SeamPatch& patch, double largest_deg)
      : triangles_(patch.triangles), edges_at_(patch.vertex.size()), triangles_at_(patch.vertex.size()) {
    const double largest = largest_deg * std::numbers::pi / 180;
    const std::vector<SeamEdge> edges = inner_edges(patch);
    const auto of_strip = [&](const SeamEdge& edge) {
      return patch.side[edge.triangles[0]] == SeamSide::strip ||
             patch.side[edge.triangles[1]] == SeamSide::strip;
    };
    std::vector<double> brought(patch.vertex.size(), largest);  // per vertex: the sharpest edge off the strips
    for (const SeamEdge& edge : edges) {
      if (of_strip(edge)) continue;
      for (const Index v : edge.ends) brought[v] = std::max(brought[v], bend(points, edge.triangles));
    }
    for (const SeamEdge& edge : edges) {
      const auto index = static_cast<Index>(edges_.size());
      const double now = bend(points, edge.triangles);
      const double crease = std::min(brought[edge.ends[0]], brought[edge.ends[1]]);
      edges_.push_back({edge.triangles, of_strip(edge) ? crease : std::max(largest, now)});
      if (of_strip(edge)) of_strip_.push_back(index);
      for (const Index t : edge.triangles) {
        for (int k = 0; k < 3; ++k) edges_at_[triangles_(t, k)].push_back(index);
      }
    }
    for (auto& around : edges_at_) {
      std::sort(around.begin(), around.end());
      around.erase(std::unique(around.begin(), around.end()), around.end());
    }
    for (Index t = 0; t < static_cast<Index>(triangles_.rows()); ++t) {
      index_.push_back(std::max(well_shaped, harmonic_index(points, t)));
      for (int k = 0; k < 3; ++k) triangles_at_[triangles_(t, k)].push_back(t);
    }
  }

  /// Returns the vertices of the triangles at those edges of the strips that are bent too far, ascending.
  std::vector<Index> at_folds(const Points& points) const {
    std::vector<Index> vertices;
    for (const Index e : of_strip_) {
      if (bend(points, edges_[e].triangles) <= edges_[e].tolerated) continue;
      for (const Index t : edges_[e].triangles) {
        for (int k = 0; k < 3; ++k) vertices.push_back(triangles_(t, k));
      }
    }
    std::sort(vertices.begin(), vertices.end());
    vertices.erase(std::unique(vertices.begin(), vertices.end()), vertices.end());
    return vertices;
  }

  /// Returns the cost terms that depend on a vertex.
  double around(const Points& points, Index v) const {
    double sum = 0;
    for (const Index e : edges_at_[v]) {
      const double excess = std::max(0.0, bend(points, edges_[e].triangles) - edges_[e].tolerated);
      sum += excess * excess;
    }
    for (const Index t : triangles_at_[v]) {
      const double excess = std::max(0.0, harmonic_index(points, t) - index_[t]);
      sum += excess * excess;
    }
    return sum;
  }

  double mean_edge(const Points& points, Index v) const {
    double sum = 0;
    for (const Index t : triangles_at_[v]) {
      for (int k = 0; k < 3; ++k) {
        sum += (points.row(triangles_(t, k)) - points.row(triangles_(t, (k + 1) % 3))).norm();
      }
    }
    return sum / (3 * static_cast<double>(triangles_at_[v].size()));
  }

 private:
  static constexpr double well_shaped = 3.5;  // the index of angles of 17°, 81° and 81°

  struct Edge {
    std::array<Index, 2> triangles;
    double tolerated = 0;
  };

  Vector3d area(const Points& points, Index t) const {
    const Vector3d a = points.row(triangles_(t, 0)), b = points.row(triangles_(t, 1)),
                   c = points.row(triangles_(t, 2));
    return (b - a).cross(c - a);
  }

  double bend(const Points& points, const std::array<Index, 2>& beside) const {
    const Vector3d a = area(points, beside[0]), b = area(points, beside[1]);
    return std::atan2(a.cross(b).norm(), a.dot(b));
  }

  double harmonic_index(const Points& points, Index t) const {
    constexpr double worst = 1e6;  // of a triangle without area
    double squares = 0;
    for (int k = 0; k < 3; ++k) {
      squares += (points.row(triangles_(t, k)) - points.row(triangles_(t, (k + 1) % 3))).squaredNorm();
    }
    const double twice_area = area(points, t).norm();
    return 2 * worst * twice_area > squares ? squares / (2 * twice_area) : worst;
  }

  const Triangles& triangles_;
  std::vector<Edge> edges_;
  std::vector<Index> of_strip_;
  std::vector<double> index_;
  std::vector<std::vector<Index>> edges_at_, triangles_at_;
};

// Moves a vertex down the gradient (central differences), halving the step until the cost decreases.
bool descend(Points& points, const Cost& cost, Index v) {
  constexpr double difference = 1e-3, longest = 0.1;  // × the mean edge
  constexpr int tries = 8;
  constexpr double settled = 1e-8;  // radians²: a hundredth of a degree, far above rounding
  const double before = cost.around(points, v);
  if (!(before > settled)) return false;
  const Eigen::RowVector3d p = points.row(v);
  const double edge = cost.mean_edge(points, v);
  Eigen::RowVector3d slope;
  for (int axis = 0; axis < 3; ++axis) {
    points(v, axis) = p[axis] + difference * edge;
    slope[axis] = cost.around(points, v);
    points(v, axis) = p[axis] - difference * edge;
    slope[axis] -= cost.around(points, v);
    points(v, axis) = p[axis];
  }
  if (!(slope.norm() > 0)) return false;
  double length = longest * edge;
  for (int k = 0; k < tries; ++k, length /= 2) {
    points.row(v) = p - length * slope.normalized();
    if (cost.around(points, v) < before) return true;
  }
  points.row(v) = p;
  return false;
}

}  // namespace

void reduce_folds(Points& points, const SeamPatch& patch, double largest_deg, const Flags& may_move,
                  const Context& context) {
  constexpr int most_sweeps = 50;
  const Cost cost(points, patch, largest_deg);
  bool moved = true;
  for (int sweep = 0; sweep < most_sweeps && moved; ++sweep) {
    context.throw_if_stopped();
    moved = false;
    for (const Index v : cost.at_folds(points)) {
      if (may_move[v]) moved |= descend(points, cost, v);
    }
  }
}

}  // namespace meshgraft
