#include "plane_section.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <set>
#include <utility>

#include <Eigen/Geometry>

#include "mesh/area_vector.h"
#include "mesh/disjoint_sets.h"
#include "mesh/winding.h"

namespace meshgraft {

namespace {

using Point = Eigen::Vector3d;

Mesh triangles_of(const Mesh& mesh) {
  return make_mesh(mesh.positions, triangulate(mesh, {.skip_out_of_range = true}).triangles);
}

/// Computes the measures of a loop from its points.
void measure(SectionLoop& loop, const Point& up) {
  const Point mean = loop.points.colwise().mean().transpose();
  Point moment = Point::Zero();
  double double_area = 0;
  const Eigen::Index count = loop.points.rows();
  for (Eigen::Index k = 0; k < count; ++k) {
    const Point a = loop.points.row(k).transpose() - mean;
    const Point b = loop.points.row((k + 1) % count).transpose() - mean;
    const double part = a.cross(b).dot(up);
    double_area += part;
    moment += part * (a + b) / 3;
    loop.length += (b - a).norm();
  }
  loop.area = double_area / 2;
  loop.centre = double_area == 0 ? mean : Point(mean + moment / double_area);
}

}  // namespace

double SectionLoop::roundness() const { return 4 * std::numbers::pi * area / (length * length); }

double SectionLoop::radius() const { return length / (2 * std::numbers::pi); }

PlaneSections::PlaneSections(const Mesh& mesh)
    : surface_(triangles_of(mesh)),
      table_(surface_.vertex_count(), surface_.faces),
      orientation_(enclosed_volume(mesh) < 0 ? -1 : 1) {}

PlaneSection PlaneSections::at(const Eigen::Vector3d& up, double height) const {
  const Points& x = surface_.positions;
  Eigen::VectorXd values = (x * up).array() - height;
  const auto above = [&](Index v) { return values[v] >= 0; };
  const std::vector<Index>& corners = surface_.faces.corners();
  PlaneSection section;
  DisjointSets pieces(surface_.vertex_count());
  // Per edge that the plane crosses upwards: the point, and the edge where its triangle is left.
  std::vector<Index> start_edges;
  for (Index e = 0; e < table_.edge_count(); ++e) {
    const auto [a, b] = table_.ends[e];
    if (above(a) && above(b)) pieces.unite(a, b);
    if (above(a) != above(b)) start_edges.push_back(e);
  }
  Flags seen(table_.edge_count(), 0);
  std::set<Index> with_loop;
  // With the surface above at its left, a loop enters each triangle by the half-edge that leads up.
  const auto tail_is_above = [&](Index corner) { return above(corners[corner]); };
  for (const Index first : start_edges) {
    if (seen[first] != 0) continue;
    std::vector<Point> points;
    SectionLoop loop;
    double weight = 0;
    Index edge = first;
    while (seen[edge] == 0) {
      seen[edge] = 1;
      const auto [a, b] = table_.ends[edge];
      const double t = values[a] / (values[a] - values[b]);
      const Point point = ((1 - t) * x.row(a) + t * x.row(b)).transpose();
      points.push_back(point);
      // The triangle in which this edge is walked downwards.
      const auto half_edges = table_.half_edges[edge];
      const auto down = std::find_if(half_edges.begin(), half_edges.end(), tail_is_above);
      if (half_edges.size() != 2 || down == half_edges.end()) {
        section.closed = false;
        break;
      }
      const Index face = *down / 3;
      Index leaving = table_.next[*down];
      if (above(corners[leaving]) == above(corners[table_.next[leaving]])) leaving = table_.next[leaving];
      const Point normal = orientation_ * area_vector(surface_.faces[face], x);
      edge = table_.edge[leaving];
      const auto [c, d] = table_.ends[edge];
      const double s = values[c] / (values[c] - values[d]);
      const Point next = ((1 - s) * x.row(c) + s * x.row(d)).transpose();
      const double length = (next - point).norm();
      if (normal.norm() > 0) {
        loop.overhang -= length * normal.dot(up) / normal.norm();
        weight += length;
      }
    }
    loop.points.resize(static_cast<Eigen::Index>(points.size()), 3);
    for (std::size_t k = 0; k < points.size(); ++k)
      loop.points.row(static_cast<Eigen::Index>(k)) = points[k].transpose();
    measure(loop, up);
    loop.area *= orientation_;
    loop.overhang /= std::max(weight, 1e-300);
    const auto [a, b] = table_.ends[first];
    with_loop.insert(pieces.root(above(a) ? a : b));
    section.loops.push_back(std::move(loop));
  }
  section.pieces = static_cast<Index>(with_loop.size());
  std::stable_sort(section.loops.begin(), section.loops.end(),
                   [](const SectionLoop& p, const SectionLoop& q) { return p.area > q.area; });
  return section;
}

}  // namespace meshgraft
