#include "seam_relaxation.h"

#include <algorithm>
#include <cmath>
#include <span>

#include <Eigen/Cholesky>
#include <Eigen/Geometry>

#include <meshgraft/mesh/normals.h>

#include "mesh/area_vector.h"

namespace meshgraft {

namespace {

using Eigen::Vector3d;

// The goal for a triangle.
struct Goal {
  Vector3d normal;        // the side that should face up
  double index = 0;       // the largest accepted harmonic index
  double small_area = 0;  // twice the area below which it counts as turned over
};

// A triangle seen from its vertex p: the other two corners in the triangle's direction.
struct Corner {
  Vector3d b, c;
  Goal goal;

  double twice_area(const Vector3d& p) const { return (b - p).cross(c - p).dot(goal.normal); }

  /// Returns q - r with q = Σ |edge|² / (2 · twice the area), and computes its gradient. The area A is
  /// replaced by (A + √(A² + 4 δ²)) / 2, which is about A where A ≫ δ and positive everywhere. An inverted
  /// triangle therefore has a gradient that turns it over (Escobar et al. 2003).
  double excess(const Vector3d& p, Vector3d& gradient) const {
    const double area = twice_area(p);
    const double root = std::hypot(area, 2 * goal.small_area);
    const double positive = (area + root) / 2;
    const double q = ((b - p).squaredNorm() + (c - p).squaredNorm() + (c - b).squaredNorm()) / (2 * positive);
    gradient = ((2 * p - b - c) - q * (positive / root) * (b - c).cross(goal.normal)) / positive;
    return q - goal.index;
  }
};

// The sum of squared excesses at a place of the vertex, with the Gauss-Newton approximation of its derivatives.
struct Cost {
  double value = 0;
  Vector3d gradient = Vector3d::Zero();  // half of it
  Eigen::Matrix3d hessian = Eigen::Matrix3d::Zero();
  bool inverted = false;  // a triangle is turned over

  Cost(const std::vector<Corner>& corners, const Vector3d& p, const Vector3d& normal) {
    for (const Corner& corner : corners) {
      Vector3d slope;
      const double excess = corner.excess(p, slope);
      if (excess <= 0) continue;
      slope -= slope.dot(normal) * normal;
      inverted |= corner.twice_area(p) < corner.goal.small_area;
      value += excess * excess;
      gradient += excess * slope;
      hessian += slope * slope.transpose();
    }
  }
};

std::vector<Corner> corners_at(const Points& points, const Triangles& triangles, std::span<const Index> around,
                               const std::vector<Goal>& goals, Index v) {
  std::vector<Corner> corners;
  for (const Index t : around) {
    const int k = triangles(t, 0) == v ? 0 : triangles(t, 1) == v ? 1 : 2;
    corners.push_back({points.row(triangles(t, (k + 1) % 3)), points.row(triangles(t, (k + 2) % 3)), goals[t]});
  }
  return corners;
}

// Moves a vertex in the tangent plane by a step that is halved until the cost decreases: a damped one of Gauss
// and Newton, which comes to rest; at a triangle that is turned over one along the gradient, which goes
// farther. Such long steps overshoot elsewhere, and differences of rounding grow tenfold by each sweep.
bool slide(Points& points, Index v, const std::vector<Corner>& corners, const Vector3d& normal) {
  constexpr double longest = 0.2;   // × the mean edge
  constexpr double damping = 1e-3;  // × the mean curvature of the cost
  constexpr double settled = 1e-8;  // of a harmonic index of 3.5 and more, squared; far above rounding
  constexpr int tries = 6;
  const Vector3d p = points.row(v);
  const Cost before(corners, p, normal);
  if (!(before.value > settled)) return false;
  double edges = 0;
  for (const Corner& corner : corners) edges += (corner.b - p).norm();
  const double limit = longest * edges / static_cast<double>(corners.size());
  const double curvature = before.hessian.trace() / 2;
  if (!(curvature > 0)) return false;
  Vector3d step = -before.gradient;
  if (!before.inverted) {
    const Eigen::Matrix3d damped = before.hessian + damping * curvature * Eigen::Matrix3d::Identity();
    step = damped.ldlt().solve(step);
    step -= step.dot(normal) * normal;
  }
  if (before.inverted || step.norm() > limit) step *= limit / step.norm();
  for (int k = 0; k < tries; ++k, step /= 2) {
    if (!(Cost(corners, p + step, normal).value < before.value)) continue;
    points.row(v) = p + step;
    return true;
  }
  return false;
}

// Returns normals of the surface at large, smoothed so that inverted triangles do not affect them.
Points smooth_normals(const Points& points, const Triangles& triangles, const IndexLists& vertex_triangles,
                      const Context& context) {
  constexpr int rounds = 3;
  Points normals = vertex_normals(points, triangles, vertex_triangles, context);
  for (int round = 0; round < rounds; ++round) {
    const Points before = normals;
    for (Eigen::Index t = 0; t < triangles.rows(); ++t) {
      for (int k = 0; k < 3; ++k) {
        normals.row(triangles(t, k)) +=
            before.row(triangles(t, (k + 1) % 3)) + before.row(triangles(t, (k + 2) % 3));
      }
    }
    normals.rowwise().normalize();
  }
  return normals;
}

std::vector<Goal> goals_of(const Points& points, const SeamPatch& patch, const Points& normals) {
  constexpr double well_shaped = 3.5;  // the index of angles of 17°, 81° and 81°
  constexpr double small = 0.05;       // × the area of an equilateral triangle of the same edges
  std::vector<Goal> goals;
  for (Eigen::Index t = 0; t < patch.triangles.rows(); ++t) {
    Goal goal;
    const Vector3d area = area_vector(patch.triangles, t, points);
    const Vector3d around = normals.row(patch.triangles(t, 0)) + normals.row(patch.triangles(t, 1)) +
                            normals.row(patch.triangles(t, 2));
    goal.normal = area.dot(around) > 0 ? area.normalized() : around.normalized();
    double squares = 0;
    for (int k = 0; k < 3; ++k) {
      squares +=
          (points.row(patch.triangles(t, k)) - points.row(patch.triangles(t, (k + 1) % 3))).squaredNorm();
    }
    goal.small_area = small * squares / (2 * std::sqrt(3.0));
    goal.index = well_shaped;
    if (patch.side[t] != SeamSide::strip) goal.index = std::max(goal.index, squares / (2 * area.norm()));
    goals.push_back(goal);
  }
  return goals;
}

}  // namespace

void relax_seam(Points& points, const SeamPatch& patch, const IndexLists& vertex_triangles,
                const Flags& may_slide, const Context& context) {
  constexpr int most_sweeps = 50;
  const Points normals = smooth_normals(points, patch.triangles, vertex_triangles, context);
  const std::vector<Goal> goals = goals_of(points, patch, normals);
  bool moved = true;
  for (int sweep = 0; sweep < most_sweeps && moved; ++sweep) {
    context.throw_if_stopped();
    moved = false;
    for (Index v = 0; v < static_cast<Index>(may_slide.size()); ++v) {
      if (!may_slide[v]) continue;
      const auto corners = corners_at(points, patch.triangles, vertex_triangles[v], goals, v);
      moved |= slide(points, v, corners, normals.row(v));
    }
  }
}

}  // namespace meshgraft
