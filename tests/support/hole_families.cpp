#include "support/hole_families.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <map>
#include <numbers>
#include <random>
#include <set>

#include <Eigen/Geometry>

#include <meshgraft/mesh/topology.h>
#include <meshgraft/samples/samples.h>

namespace meshgraft::test {

namespace {

using Eigen::RowVector3d;
using Eigen::Vector2d;
using std::numbers::pi;

using Outline = std::function<Vector2d(double)>;              // from 0 … 1, counter-clockwise
using Surface = std::function<RowVector3d(const Vector2d&)>;  // over the plane of the outline

RowVector3d turned(double x, double y, double z) {
  static const Eigen::Matrix3d rotation = (Eigen::AngleAxisd(0.7, Eigen::Vector3d(1, 2, 3).normalized()) *
                                           Eigen::AngleAxisd(0.4, Eigen::Vector3d::UnitX()))
                                              .toRotationMatrix();
  return (rotation * Eigen::Vector3d(x, y, z)).transpose();
}

double jitter(std::mt19937& random) { return static_cast<double>(random()) / 4294967296.0 - 0.5; }

HoleCase over(Index n, const Outline& outline, const Surface& surface) {
  HoleCase hole;
  hole.points.resize(n, 3);
  hole.beyond.resize(n, 3);
  for (Index k = 0; k < n; ++k) {
    const Vector2d a = outline(double(k) / n), b = outline(double(k + 1) / n);
    const Vector2d along = b - a;
    hole.points.row(k) = surface(a);
    hole.beyond.row(k) = surface((a + b) / 2 + 0.9 * Vector2d(along[1], -along[0]));
  }
  return hole;
}

Vector2d polar(double radius, double t) {
  return radius * Vector2d(std::cos(2 * pi * t), std::sin(2 * pi * t));
}

RowVector3d plane(const Vector2d& p) { return turned(p[0], p[1], 0); }
RowVector3d sphere(const Vector2d& p) {
  const double angle = 0.9 * p.norm(), s = p.norm() > 0 ? std::sin(angle) / p.norm() : 0.9;
  return turned(s * p[0], s * p[1], std::cos(angle));
}
RowVector3d saddle(const Vector2d& p) { return turned(p[0], p[1], 0.6 * (p[0] * p[0] - p[1] * p[1])); }
RowVector3d cylinder(const Vector2d& p) { return turned(std::sin(1.8 * p[0]), p[1], std::cos(1.8 * p[0])); }
RowVector3d bumpy(const Vector2d& p) {
  return turned(p[0], p[1],
                0.2 * std::sin(4 * p[0] + 1) * std::cos(3 * p[1]) + 0.3 * p[0] * p[1] - 0.2 * p.squaredNorm());
}

HoleCase ragged(Index n) {
  std::mt19937 random(7 + n);
  std::vector<Vector2d> corners(n);
  for (Index k = 0; k < n; ++k)
    corners[k] = polar(1 + std::min(0.3, 6.0 / n) * jitter(random), (k + 0.5 * jitter(random)) / n);
  return over(n, [&](double t) { return corners[std::lround(t * n) % n]; }, bumpy);
}

// Returns the border of a winding ramp: up a helix and down a narrower one.
HoleCase helix(Index n) {
  HoleCase hole;
  hole.points.resize(n, 3);
  hole.beyond.resize(n, 3);
  const Index up = (n + 1) / 2, down = n - up;
  const auto on = [](double radius, double t) {
    const double angle = 2 * pi * 1.4 * t;
    return turned(radius * std::cos(angle), radius * std::sin(angle), 0.8 * t);
  };
  for (Index k = 0; k < n; ++k) {
    const bool outer = k < up;
    const double step = outer ? 1.0 / up : 1.0 / down;
    const double t = outer ? step * k : 1 - step * (k - up);
    const double half = outer ? t + step / 2 : t - step / 2;
    hole.points.row(k) = on(outer ? 1 : 0.5, t);
    hole.beyond.row(k) = on(outer ? 1 + 2 * step : 0.5 - std::min(0.3, 2 * step), half);
  }
  return hole;
}

// Returns the hole that a ball cuts into a model.
HoleCase scan(Index edges) {
  static const Mesh model = make_sample("head", 220);
  const Triangulation triangulation = triangulate(model);
  const Triangles& triangles = triangulation.triangles;
  HoleCase best;
  const RowVector3d centre = model.positions.row(model.vertex_count() / 3);
  const double spacing = 2.2 / 220;
  std::map<std::pair<Index, Index>, Index> corner_beyond;  // third corners by half-edge, outside the ball
  const double radius = spacing * edges / 9;
  std::vector<char> inside(model.vertex_count());
  for (Index v = 0; v < model.vertex_count(); ++v)
    inside[v] = (model.positions.row(v) - centre).norm() < radius;
  Mesh rest;
  rest.positions = model.positions;
  for (Eigen::Index t = 0; t < triangles.rows(); ++t) {
    const std::array<Index, 3> face{triangles(t, 0), triangles(t, 1), triangles(t, 2)};
    if (inside[face[0]] || inside[face[1]] || inside[face[2]]) continue;
    rest.faces.push_back(face);
    for (int k = 0; k < 3; ++k) corner_beyond[{face[k], face[(k + 1) % 3]}] = face[(k + 2) % 3];
  }
  std::vector<Index> longest;
  for (const auto& loop : boundary_loops(rest)) {
    const std::set<Index> distinct(loop.begin(), loop.end());
    const bool around = (model.positions.row(loop[0]) - centre).norm() < 1.5 * radius + 2 * spacing;
    if (around && distinct.size() == loop.size() && loop.size() > longest.size()) longest = loop;
  }
  const auto n = static_cast<Index>(longest.size());
  if (n == 0) return best;
  best.points.resize(n, 3);
  best.beyond.resize(n, 3);
  const bool runs_with_faces = corner_beyond.contains({longest[0], longest[1 % n]});
  if (runs_with_faces) std::reverse(longest.begin(), longest.end());
  for (Index k = 0; k < n; ++k) {
    best.points.row(k) = model.positions.row(longest[k]);
    best.beyond.row(k) = model.positions.row(corner_beyond.at({longest[(k + 1) % n], longest[k]}));
  }
  return best;
}

}  // namespace

std::string HoleCase::name() const {
  return family + ", " + std::to_string(size()) + " edges" +
         (beyond.rows() > 0 ? ", faces around it known" : "");
}

const std::vector<std::string>& hole_family_names() {
  static const std::vector<std::string> names{"flat",     "star",   "sphere", "saddle",
                                              "cylinder", "ragged", "helix",  "scan"};
  return names;
}

HoleCase make_hole(const std::string& family, Index edges, bool with_beyond) {
  const auto wobbling = [](double amount, int waves) {
    return [=](double t) { return polar(1 + amount * std::sin(2 * pi * waves * t + 0.3), t); };
  };
  HoleCase hole;
  if (family == "flat") hole = over(edges, wobbling(0.1, 2), plane);
  if (family == "star") hole = over(edges, wobbling(0.6, 5), plane);
  if (family == "sphere") hole = over(edges, wobbling(0.3, 3), sphere);
  if (family == "saddle") hole = over(edges, wobbling(0.1, 2), saddle);
  if (family == "cylinder") hole = over(edges, wobbling(0.2, 3), cylinder);
  if (family == "ragged") hole = ragged(edges);
  if (family == "helix") hole = helix(edges);
  if (family == "scan") hole = scan(edges);
  hole.family = family;
  if (!with_beyond) hole.beyond.resize(0, 3);
  return hole;
}

std::vector<HoleCase> hole_cases(Index most_edges) {
  std::vector<HoleCase> cases;
  for (const std::string& family : hole_family_names())
    for (const Index edges : {3, 4, 5, 7, 10, 20, 40, 80, 150, 300, 600, 1200, 2500, 5000})
      for (const bool with_beyond : {false, true}) {
        if (edges > most_edges || (family == "scan" && (edges > 1200 || edges < 10))) continue;
        HoleCase hole = make_hole(family, edges, with_beyond);
        if (hole.size() > 2 && hole.size() <= most_edges) cases.push_back(std::move(hole));
      }
  return cases;
}

HoleCost hole_cost(const HoleCase& hole, const std::vector<std::array<Index, 3>>& triangles) {
  const Index n = hole.size();
  HoleCost cost;
  std::map<std::pair<Index, Index>, RowVector3d> normals;
  const auto meet = [&](Index a, Index b, const RowVector3d& normal) {
    const auto [entry, is_first] = normals.try_emplace(std::minmax(a, b), normal);
    if (is_first || entry->second.isZero(0) || normal.isZero(0)) return;
    const double angle = std::atan2(entry->second.cross(normal).norm(), entry->second.dot(normal));
    cost.angle = std::max(cost.angle, angle);
  };
  const auto unit = [](const RowVector3d& a, const RowVector3d& b, const RowVector3d& c) {
    const RowVector3d area = (b - a).cross(c - a);
    return RowVector3d(area.norm() > 1e-13 * (b - a).norm() * (c - a).norm() ? RowVector3d(area / area.norm())
                                                                             : RowVector3d::Zero());
  };
  for (Index k = 0; k < hole.beyond.rows(); ++k) {
    const Index next = (k + 1) % n;
    meet(k, next, unit(hole.points.row(next), hole.points.row(k), hole.beyond.row(k)));
  }
  for (const auto& t : triangles) {
    const RowVector3d a = hole.points.row(t[0]), b = hole.points.row(t[1]), c = hole.points.row(t[2]);
    cost.area += (b - a).cross(c - a).norm() / 2;
    for (int k = 0; k < 3; ++k) meet(t[k], t[(k + 1) % 3], unit(a, b, c));
  }
  return cost;
}

std::string hole_faults(Index n, const std::vector<std::array<Index, 3>>& triangles) {
  if (static_cast<Index>(triangles.size()) != n - 2) return std::to_string(triangles.size()) + " triangles";
  std::map<std::pair<Index, Index>, int> uses;
  for (const auto& t : triangles)
    for (int k = 0; k < 3; ++k)
      if (++uses[{t[k], t[(k + 1) % 3]}] > 1) return "an edge is used twice in one direction";
  for (const auto& [edge, count] : uses) {
    const auto [a, b] = edge;
    const bool along_loop = (a + 1) % n == b, against = (b + 1) % n == a;
    if (against) return "an edge of the loop is used against it";
    if (!along_loop && !uses.contains({b, a})) return "an inner edge has one triangle";
  }
  for (Index k = 0; k < n; ++k)
    if (!uses.contains({k, (k + 1) % n})) return "an edge of the loop has no triangle";
  return {};
}

}  // namespace meshgraft::test
