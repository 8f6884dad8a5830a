#include "print_check.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>
#include <numeric>

#include <Eigen/Geometry>

#include <meshgraft/mesh/topology.h>

#include "core/parallel.h"
#include "mesh/area_vector.h"
#include "mesh/edge_table.h"
#include "mesh/ray_tracer.h"

namespace meshgraft {

namespace {

using Eigen::Vector3d;

/// A ray leaves a wall through a face whose normal is at most this far from its direction: 30°.
constexpr double least_parallel_cosine = 0.866;

bool is_finite(const Mesh& mesh, const Triangles& triangles, Eigen::Index t) {
  return mesh.positions.row(triangles(t, 0)).allFinite() && mesh.positions.row(triangles(t, 1)).allFinite() &&
         mesh.positions.row(triangles(t, 2)).allFinite();
}

// Removes triangles without finite coordinates.
void keep_finite(const Mesh& mesh, Triangulation& surface) {
  Eigen::Index kept = 0;
  for (Eigen::Index t = 0; t < surface.triangles.rows(); ++t) {
    if (!is_finite(mesh, surface.triangles, t)) continue;
    surface.triangles.row(kept) = surface.triangles.row(t);
    surface.face[kept++] = surface.face[t];
  }
  surface.triangles.conservativeResize(kept, Eigen::NoChange);
  surface.face.resize(static_cast<std::size_t>(kept));
}

Eigen::AlignedBox3d bounds_of(const Mesh& mesh, const Triangles& triangles) {
  Eigen::AlignedBox3d box;
  for (Eigen::Index t = 0; t < triangles.rows(); ++t)
    for (const Index v : triangles.row(t)) box.extend(mesh.positions.row(v).transpose());
  return box;
}

// Finds the edges where the surface is open or unclear. Faces without finite coordinates do not count.
void find_edges(PrintCheck& check, const Mesh& mesh) {
  const EdgeTable table(mesh.vertex_count(), mesh.faces);
  const auto is_of_finite_face = [&](Index half_edge) {
    Index corner = half_edge;
    do {
      if (!mesh.positions.row(mesh.faces.corners()[corner]).allFinite()) return false;
      corner = table.next[corner];
    } while (corner != half_edge);
    return true;
  };
  std::vector<Index> half_edges;
  for (Index e = 0; e < table.edge_count(); ++e) {
    half_edges.clear();
    std::ranges::copy_if(table.half_edges[e], std::back_inserter(half_edges), is_of_finite_face);
    if (half_edges.size() == 1) check.open_edges.push_back(table.ends[e]);
    if (half_edges.size() > 2) check.non_manifold_edges.push_back(table.ends[e]);
    if (half_edges.size() == 2 && mesh.faces.corners()[half_edges[0]] == mesh.faces.corners()[half_edges[1]])
      check.turned_edges.push_back(table.ends[e]);
  }
  check.holes = static_cast<Index>(boundary_loops(mesh).size());
}

// Sums areas, and the volume where the surface encloses one.
void measure(PrintCheck& check, const Mesh& mesh, const Vector3d& middle) {
  const Triangles& triangles = check.surface.triangles;
  double volume = 0;
  for (Eigen::Index t = 0; t < triangles.rows(); ++t) {
    const Vector3d twice_area = area_vector(triangles, t, mesh.positions);
    check.area += twice_area.norm() / 2;
    volume += twice_area.dot(mesh.positions.row(triangles(t, 0)).transpose() - middle) / 6;
  }
  if (!check.open_edges.empty() || !check.non_manifold_edges.empty() || !check.turned_edges.empty()) return;
  if (triangles.rows() == 0) return;
  check.volume = std::abs(volume);
  check.inside_out = volume < 0;
}

void find_overhangs(PrintCheck& check, const Mesh& mesh, const PrintCheckOptions& options, double diagonal) {
  constexpr double bed_tolerance = 1e-4;  // × the diagonal
  const Triangles& triangles = check.surface.triangles;
  const Vector3d up = options.up.normalized();
  const auto height = [&](Index v) { return mesh.positions.row(v).dot(up); };
  double bed = std::numeric_limits<double>::infinity();
  for (Eigen::Index t = 0; t < triangles.rows(); ++t)
    for (const Index v : triangles.row(t)) bed = std::min(bed, height(v));
  const double least_sine = std::sin(options.overhang_deg * std::acos(-1.0) / 180);
  const double outward = check.inside_out ? -1 : 1;
  for (Eigen::Index t = 0; t < triangles.rows(); ++t) {
    const Vector3d twice_area = outward * area_vector(triangles, t, mesh.positions);
    const double area = twice_area.norm() / 2;
    if (!(area > 0) || !(-twice_area.dot(up) > least_sine * 2 * area)) continue;
    const double top = std::max({height(triangles(t, 0)), height(triangles(t, 1)), height(triangles(t, 2))});
    if (top - bed <= bed_tolerance * diagonal) continue;
    check.overhanging.push_back(static_cast<Index>(t));
    check.overhang_area += area;
  }
}

/// A surface in units of its size from its middle, as the ray tracer takes it.
struct Traced {
  const Mesh& mesh;
  const Triangles& triangles;
  Vector3d middle;
  double size;

  Vector3d corner(Eigen::Index t, int c) const {
    return (mesh.positions.row(triangles(t, c)).transpose() - middle) / size;
  }
  std::vector<RayTriangle> all() const {
    std::vector<RayTriangle> traced(static_cast<std::size_t>(triangles.rows()));
    for (std::size_t t = 0; t < traced.size(); ++t)
      for (int c = 0; c < 3; ++c)
        traced[t][static_cast<std::size_t>(c)] = corner(static_cast<Eigen::Index>(t), c).cast<float>();
    return traced;
  }
  Vector3d normal(Eigen::Index t) const {
    return (corner(t, 1) - corner(t, 0)).cross(corner(t, 2) - corner(t, 0)).stableNormalized();
  }
};

bool share_a_vertex(const Triangles& triangles, Eigen::Index a, Eigen::Index b) {
  for (const Index v : triangles.row(a))
    if ((triangles.row(b).array() == v).any()) return true;
  return false;
}

// Returns the thickness at the centre of a triangle, relative to the size; infinity if there is no wall. Faces
// that share a vertex make an edge, at which the thickness would only tell the size of the faces.
double thickness_at(const Traced& surface, const RayTracer& tracer, Eigen::Index t, double outward) {
  constexpr double none = std::numeric_limits<double>::infinity();
  constexpr double clearance = 1e-5;  // so that the triangle itself is not met
  const Vector3d inward = -outward * surface.normal(t);
  if (inward.isZero(0)) return none;
  const Vector3d centre = (surface.corner(t, 0) + surface.corner(t, 1) + surface.corner(t, 2)) / 3;
  const Vector3d origin = centre + clearance * inward;
  const auto hit = tracer.first_hit(origin.cast<float>(), inward.cast<float>());
  if (!hit || share_a_vertex(surface.triangles, t, hit->triangle)) return none;
  if (outward * surface.normal(hit->triangle).dot(inward) < least_parallel_cosine) return none;
  return hit->distance + clearance;
}

void find_walls(PrintCheck& check, const PrintCheckOptions& options, const Traced& surface,
                const Context& context) {
  const RayTracer tracer(surface.all(), context);
  context.throw_if_stopped();
  std::vector<double> thickness(static_cast<std::size_t>(surface.triangles.rows()));
  const double outward = check.inside_out ? -1 : 1;
  parallel_blocks(
      thickness.size(),
      [&](std::size_t begin, std::size_t end) {
        for (std::size_t t = begin; t < end; ++t)
          thickness[t] = thickness_at(surface, tracer, static_cast<Eigen::Index>(t), outward) * surface.size;
      },
      context);
  const auto thinnest = std::ranges::min_element(thickness);
  if (thinnest == thickness.end() || !std::isfinite(*thinnest)) return;
  check.thinnest_wall = *thinnest;
  const double limit = *thinnest < options.least_wall ? options.least_wall : 1.1 * *thinnest;
  for (std::size_t t = 0; t < thickness.size(); ++t)
    if (thickness[t] < limit) check.thin.push_back(static_cast<Index>(t));
}

}  // namespace

PrintCheck check_print(const Mesh& mesh, const PrintCheckOptions& options, const Context& context) {
  PrintCheck check;
  check.surface = triangulate(mesh, {.skip_out_of_range = true});
  keep_finite(mesh, check.surface);
  const Eigen::AlignedBox3d box = bounds_of(mesh, check.surface.triangles);
  if (box.isEmpty()) return check;
  check.size = box.sizes();
  context.throw_if_stopped();
  find_edges(check, mesh);
  measure(check, mesh, box.center());
  find_overhangs(check, mesh, options, check.size.norm());
  context.step("measure");
  if (const double size = check.size.norm(); size > 0 && std::isfinite(size))
    find_walls(check, options, {mesh, check.surface.triangles, box.center(), size}, context);
  std::vector<Index> all(static_cast<std::size_t>(mesh.vertex_count()));
  std::iota(all.begin(), all.end(), Index{0});
  check.intersections = self_intersections(mesh.positions, check.surface.triangles, all, context);
  return check;
}

}  // namespace meshgraft
