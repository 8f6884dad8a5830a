#include "shell_surface.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include <Eigen/Cholesky>
#include <Eigen/Geometry>

#include "core/parallel.h"
#include "mesh/disjoint_sets.h"
#include "mesh/edge_table.h"
#include "rotations.h"

namespace meshgraft {

namespace {

double area_of(const Eigen::Vector3d& a, const Eigen::Vector3d& b, const Eigen::Vector3d& c) {
  return (b - a).cross(c - a).norm() / 2;
}

bool repeats_corner(const Eigen::RowVector3<Index>& t) { return t[0] == t[1] || t[1] == t[2] || t[2] == t[0]; }

/// The area of faces, × the square of an edge, below which they are too thin to bend or to keep it.
constexpr double thinnest = 1e-4;

/// Returns the corner of a triangle that is not an end of the edge.
Index corner_across(const Eigen::RowVector3<Index>& t, const std::array<Index, 2>& ends) {
  for (const Index v : t)
    if (v != ends[0] && v != ends[1]) return v;
  return -1;
}

}  // namespace

HingeShape hinge_shape(const std::array<Eigen::Vector3d, 4>& points, bool bends) {
  HingeShape shape;
  shape.length_slope.fill(Eigen::Vector3d::Zero());
  shape.angle_slope.fill(Eigen::Vector3d::Zero());
  const Eigen::Vector3d edge = points[1] - points[0];
  const double length = edge.norm();
  shape.length = length;
  if (!(length > 0)) return shape;
  shape.length_slope = {-edge / length, edge / length, Eigen::Vector3d::Zero(), Eigen::Vector3d::Zero()};
  if (!bends) return shape;
  const Eigen::Vector3d a = points[2] - points[0], b = points[3] - points[0];
  const Eigen::Vector3d left = edge.cross(a), right = b.cross(edge);  // normals, as long as twice the areas
  const double left_squared = left.squaredNorm(), right_squared = right.squaredNorm();
  if (!(left_squared > 0 && right_squared > 0)) return shape;
  shape.angle = std::atan2(edge.dot(left.cross(right)) / length, left.dot(right));
  const Eigen::Vector3d of_left = -length / left_squared * left, of_right = -length / right_squared * right;
  const double left_share = a.dot(edge) / (length * length), right_share = b.dot(edge) / (length * length);
  shape.angle_slope = {-(1 - left_share) * of_left - (1 - right_share) * of_right,
                       -left_share * of_left - right_share * of_right, of_left, of_right};
  return shape;
}

ShellSurface::ShellSurface(const ConstrainedSystem& system, const LimbTwist& limbs, const Context& context)
    : system_(system), limbs_(limbs) {
  choose_moving(context);
  list_hinges(context);
  measure_edges();
  grade_bending();
}

/// Flags the vertices that nothing holds by itself.
Flags ShellSurface::free_vertices() const {
  const Patch& patch = system_.patch();
  const ConstraintMask& mask = system_.mask();
  Flags is_free(patch.size(), 0), is_clamped(patch.size(), 0);
  for (Index v = 0; v < patch.size(); ++v) is_free[v] = mask.is_movable(v) && !mask.anchored[v] ? 1 : 0;
  const auto has_map = [&](Index v) { return !mask.is_fitted(v); };
  for (const auto& t : patch.triangles.rowwise())
    if (std::all_of(t.begin(), t.end(), has_map))
      for (const Index v : t) is_clamped[v] = 1;
  for (Index v = 0; v < patch.size(); ++v)
    if (has_map(v) && !is_clamped[v])
      for (const Index w : system_.operators()->rings()[v]) is_free[w] = 0;
  return is_free;
}

/// Lists the moving vertices, their components and faces. A component that touches no held vertex has nothing
/// to hold it, so that it does not move.
void ShellSurface::choose_moving(const Context& context) {
  const Patch& patch = system_.patch();
  const Flags free = free_vertices();
  const auto is_free = [&](Index v) { return free[v] != 0; };
  DisjointSets sets(patch.size());
  Flags is_held(patch.size(), 0), has_face(patch.size(), 0);
  for (const auto& t : patch.triangles.rowwise()) {
    if (repeats_corner(t)) continue;
    for (int c = 0; c < 3; ++c)
      if (is_free(t[c]) && is_free(t[(c + 1) % 3])) sets.unite(t[c], t[(c + 1) % 3]);
    for (const Index v : t) has_face[v] = 1;
  }
  context.throw_if_stopped();
  for (const auto& t : patch.triangles.rowwise()) {
    if (repeats_corner(t) || std::all_of(t.begin(), t.end(), is_free)) continue;
    for (const Index v : t)
      if (is_free(v)) is_held[sets.root(v)] = 1;
  }
  std::vector<Index> component(patch.size(), -1);  // of each root
  unknown_.assign(patch.size(), -1);
  for (Index v = 0; v < patch.size(); ++v) {
    if (!has_face[v] || !is_free(v) || !is_held[sets.root(v)]) continue;
    unknown_[v] = static_cast<Index>(moving_.size());
    moving_.push_back(v);
    if (component[sets.root(v)] < 0) component[sets.root(v)] = components_++;
  }
  for (const auto& t : patch.triangles.rowwise()) {
    const auto moves = std::find_if(t.begin(), t.end(), [&](Index v) { return unknown_[v] >= 0; });
    if (moves == t.end() || repeats_corner(t)) continue;
    faces_.emplace_back(t.transpose());
    component_of_face_.push_back(component[sets.root(*moves)]);
  }
}

/// Lists the edges with a moving end, and those at which a face with a moving corner bends.
void ShellSurface::list_hinges(const Context& context) {
  const Patch& patch = system_.patch();
  const Triangles& triangles = patch.triangles;
  std::vector<Index> component(patch.size(), -1);
  for (std::size_t f = 0; f < faces_.size(); ++f)
    for (const Index v : faces_[f])
      if (unknown_[v] >= 0) component[v] = component_of_face_[f];
  const auto point = [&](Index v) { return Eigen::Vector3d(patch.points.row(v)); };
  const std::vector<TriangleEdge> edges =
      list_edges(triangles, vertex_triangles(patch.size(), triangles, context), context);
  for (const TriangleEdge& edge : edges) {
    Hinge hinge{
        .vertices = {edge.ends[0], edge.ends[1], corner_across(triangles.row(edge.faces[0]), edge.ends), -1}};
    if (edge.joins_two_faces()) hinge.vertices[3] = corner_across(triangles.row(edge.faces[1]), edge.ends);
    const auto& [v0, v1, v2, v3] = hinge.vertices;
    if (v3 >= 0) {  // the angle of faces that are needles is not defined
      const double smallest = thinnest * (point(v1) - point(v0)).squaredNorm();
      if (v2 == v3 || area_of(point(v0), point(v1), point(v2)) < smallest ||
          area_of(point(v0), point(v1), point(v3)) < smallest)
        hinge.vertices[3] = -1;
    }
    hinge.stretches = unknown_[v0] >= 0 || unknown_[v1] >= 0;
    const auto moves = std::find_if(hinge.vertices.begin(), hinge.vertices.end(),
                                    [&](Index v) { return v >= 0 && unknown_[v] >= 0; });
    if (moves == hinge.vertices.end() || (!hinge.stretches && hinge.vertices[3] < 0)) continue;
    if (!(point(v1) != point(v0))) continue;
    hinge.component = component[*moves];
    hinges_.push_back(hinge);
  }
}

/// Sets the shortest length of each component to a thousandth of its mean.
void ShellSurface::measure_edges() {
  shortest_.assign(components_, 0);
  std::vector<double> counts(components_, 0);
  for (const Hinge& hinge : hinges_) {
    const std::array<Eigen::Vector3d, 4> corners = points(hinge, system_.patch().points);
    shortest_[hinge.component] += (corners[1] - corners[0]).norm();
    ++counts[hinge.component];
  }
  for (Index c = 0; c < components_; ++c) shortest_[c] *= 1e-3 / counts[c];
}

/// Raises the bending energy towards held vertices, so that no edge kinks there: by (c D/d)³, where D is the
/// size of the component and d the distance from held vertices along edges.
void ShellSurface::grade_bending() {
  constexpr double reach = 0.01, exponent = 3;
  if (moving_.empty()) return;
  const Points& points = system_.patch().points;
  std::vector<Index> held;
  for (Index v = 0; v < system_.patch().size(); ++v)
    if (unknown_[v] < 0) held.push_back(v);
  const std::vector<double> distance = edge_distance(held, points, system_.operators()->rings());
  std::vector<double> areas(components_, 0);
  for (std::size_t f = 0; f < faces_.size(); ++f)
    areas[component_of_face_[f]] +=
        area_of(points.row(faces_[f][0]), points.row(faces_[f][1]), points.row(faces_[f][2]));
  for (Hinge& hinge : hinges_) {
    const auto& [v0, v1, v2, v3] = hinge.vertices;
    const double nearest =
        std::max((points.row(v1) - points.row(v0)).norm(), 100 * shortest_[hinge.component]) / 4;
    const bool at_held = unknown_[v0] < 0 || unknown_[v1] < 0;
    const double d = at_held ? nearest : std::max(nearest, (distance[v0] + distance[v1]) / 2);
    hinge.bending = 1 + std::pow(reach * std::sqrt(areas[hinge.component]) / d, exponent);
  }
}

void ShellSurface::follow(const Points& before, const Points& after, Columns& maps) const {
  std::vector<Eigen::Matrix3d> own(moving_.size(), Eigen::Matrix3d::Zero()), both = own;
  Points normal_before = Points::Zero(static_cast<Eigen::Index>(moving_.size()), 3),
         normal_after = normal_before;
  for (const Eigen::Vector3<Index>& t : faces_) {
    const auto add_normal = [&](const Points& points, Points& normals) {
      const Eigen::RowVector3d u = points.row(t[1]) - points.row(t[0]), v = points.row(t[2]) - points.row(t[0]);
      for (const Index corner : t)
        if (unknown_[corner] >= 0) normals.row(unknown_[corner]) += u.cross(v);
    };
    add_normal(before, normal_before);
    add_normal(after, normal_after);
  }
  const auto add = [](const Eigen::RowVector3d& a, const Eigen::RowVector3d& b, Eigen::Matrix3d& squares,
                      Eigen::Matrix3d& products) {
    squares += a.transpose() * a;
    products += a.transpose() * b;
  };
  for (const Hinge& hinge : hinges_) {
    if (!hinge.stretches) continue;
    const auto& [v0, v1, v2, v3] = hinge.vertices;
    for (const Index u : {unknown_[v0], unknown_[v1]})
      if (u >= 0) add(before.row(v1) - before.row(v0), after.row(v1) - after.row(v0), own[u], both[u]);
  }
  for (std::size_t u = 0; u < moving_.size(); ++u) {
    const auto row = static_cast<Eigen::Index>(u);
    const double length = std::sqrt(own[u].trace() / 2);  // of the normals, like the edges
    add(length * normal_before.row(row).normalized(), length * normal_after.row(row).normalized(), own[u],
        both[u]);
    auto map = maps.middleRows<3>(3 * static_cast<Eigen::Index>(moving_[u]));
    const Eigen::Matrix3d turn = own[u].ldlt().solve(both[u]);  // Dᵀ
    if (turn.allFinite())
      map = ((map + Eigen::Matrix3d::Identity()) * turn - Eigen::Matrix3d::Identity()).eval();
  }
}

std::array<Eigen::Vector3d, 4> ShellSurface::points(const Hinge& hinge, const Points& positions) const {
  std::array<Eigen::Vector3d, 4> points;
  for (std::size_t k = 0; k < 4; ++k) points[k] = positions.row(std::max(hinge.vertices[k], 0)).transpose();
  return points;
}

/// Returns the corners of a hinge at rest under a strain, up to a motion. The maps of its edges are those at
/// their middles. On a limb that twists they turn against each other, as they do on the helix.
std::array<Eigen::Vector3d, 4> ShellSurface::strained(const Hinge& hinge, const RestStrain& strain) const {
  const std::array<Index, 4>& v = hinge.vertices;
  const std::array<Eigen::Vector3d, 4> p = points(hinge, system_.patch().points);
  Eigen::Matrix3d twist = Eigen::Matrix3d::Zero();  // rotation vector per offset
  if (!strain.turning.empty())
    for (const Index end : {v[0], v[1]})
      twist += 0.5 * strain.turning[end] * limbs_.at(end).direction.transpose();
  const auto along = [&](std::size_t a, std::size_t b) -> Eigen::Vector3d {
    const Eigen::Vector3d offset = (p[a] + p[b] - p[0] - p[1]) / 2;
    return rotation_exp(twist * offset) * ((strain.stretch[v[a]] + strain.stretch[v[b]]) / 2 * (p[b] - p[a]));
  };
  std::array<Eigen::Vector3d, 4> corners{Eigen::Vector3d::Zero(), along(0, 1), Eigen::Vector3d::Zero(),
                                         Eigen::Vector3d::Zero()};
  for (const std::size_t c : {2, 3})
    if (v[c] >= 0) corners[c] = (along(0, c) + corners[1] + along(1, c)) / 2;
  return corners;
}

/// Returns the wanted angle of a hinge, where it is `strained` on the strained surface. Towards held vertices,
/// which no strain turns, it is that under one stretch for all corners instead: a limb does not kink there.
double ShellSurface::wanted_angle(const Hinge& hinge, const RestStrain& strain, double strained) const {
  std::array<Eigen::Vector3d, 4> corners = points(hinge, system_.patch().points);
  const Eigen::Matrix3d stretch = (strain.stretch[hinge.vertices[0]] + strain.stretch[hinge.vertices[1]]) / 2;
  for (Eigen::Vector3d& corner : corners) corner = stretch * corner;
  const double plain = hinge_shape(corners, true).angle;
  return plain + std::remainder(strained - plain, 2 * std::numbers::pi) / (hinge.bending * hinge.bending);
}

ShellSurface::Metric ShellSurface::metric(const RestStrain& strain, const Context& context) const {
  Metric metric;
  metric.lengths.resize(hinges_.size());
  metric.angles.resize(hinges_.size());
  metric.areas.resize(hinges_.size());
  metric.face_areas.resize(faces_.size());
  parallel_blocks(
      hinges_.size(),
      [&](std::size_t begin, std::size_t end) {
        for (std::size_t h = begin; h < end; ++h) {
          const Hinge& hinge = hinges_[h];
          const bool bends = hinge.vertices[3] >= 0;
          const std::array<Eigen::Vector3d, 4> wanted = strained(hinge, strain);
          const HingeShape shape = hinge_shape(wanted, bends);
          metric.lengths[h] = shape.length;
          metric.angles[h] = bends ? wanted_angle(hinge, strain, shape.angle) : 0;
          const double left = area_of(wanted[0], wanted[1], wanted[2]),
                       right = bends ? area_of(wanted[0], wanted[1], wanted[3]) : 0;
          // Thin faces are not to be stiffer than this, so that they do not hold the others.
          constexpr double smallest = 0.02;
          metric.areas[h] = std::max(
              (left + right) / 3, smallest * std::pow(std::max(shape.length, shortest_[hinge.component]), 2));
        }
      },
      context);
  parallel_blocks(
      faces_.size(),
      [&](std::size_t begin, std::size_t end) {
        for (std::size_t f = begin; f < end; ++f) metric.face_areas[f] = wanted_area(faces_[f], strain);
      },
      context);
  metric.hinge_sums.assign(components_, 0);
  for (std::size_t h = 0; h < hinges_.size(); ++h) metric.hinge_sums[hinges_[h].component] += metric.areas[h];
  metric.face_sums.assign(components_, 0);
  for (std::size_t f = 0; f < faces_.size(); ++f)
    metric.face_sums[component_of_face_[f]] += metric.face_areas[f];
  return metric;
}

/// Returns the wanted area of a face, or 0 if it is so thin that its area means nothing.
double ShellSurface::wanted_area(const Eigen::Vector3<Index>& face, const RestStrain& strain) const {
  const Points& rest = system_.patch().points;
  const Eigen::Matrix3d stretch =
      (strain.stretch[face[0]] + strain.stretch[face[1]] + strain.stretch[face[2]]) / 3;
  const Eigen::Vector3d u = stretch * (rest.row(face[1]) - rest.row(face[0])).transpose(),
                        v = stretch * (rest.row(face[2]) - rest.row(face[0])).transpose();
  const double area = u.cross(v).norm() / 2;
  return area > thinnest * std::max(u.squaredNorm(), v.squaredNorm()) ? area : 0;
}

}  // namespace meshgraft
