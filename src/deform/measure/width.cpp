#include "width.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include <Eigen/Geometry>

#include "core/parallel.h"
#include "crossed_cells.h"
#include "mesh/ray_tracer.h"

namespace meshgraft {

namespace {

using Eigen::Vector3d;

constexpr std::size_t most_rays = 20000;
/// From so many triangles on, it takes less time to leave out those that no ray comes near.
constexpr std::size_t many_triangles = std::size_t{1} << 18;
/// A ray leaves a body where the normal of the surface is at most this far from its direction: 60°.
constexpr double least_cosine = 0.5;

/// The surface at rest in units of the size of its free part, from the middle of that.
struct Rest {
  const Points& points;
  const Triangles& triangles;
  Vector3d middle;
  double size;

  Vector3d at(Index v) const { return (points.row(v).transpose() - middle) / size; }
  Vector3d corner(Eigen::Index t, int c) const { return at(triangles(t, c)); }
};

/// A free vertex and the ray from it into the body.
struct Probe {
  Index vertex = -1;
  Vector3d inward = Vector3d::Zero();         ///< unit length, or zero where there is no normal
  Vector3d inward_edited = Vector3d::Zero();  ///< in the edited state, of any length
  double edge = 0;                            ///< mean length of the edges around the vertex
};

std::vector<Index> choose_vertices(std::span<const std::uint8_t> is_free) {
  std::vector<Index> free;
  for (std::size_t v = 0; v < is_free.size(); ++v)
    if (is_free[v] != 0) free.push_back(static_cast<Index>(v));
  const std::size_t step = std::max<std::size_t>(1, (free.size() + most_rays - 1) / most_rays);
  std::vector<Index> chosen;
  for (std::size_t k = 0; k < free.size(); k += step) chosen.push_back(free[k]);
  return chosen;
}

/// Returns the triangles within the size of the free part's box.
std::vector<Index> triangles_near(const Rest& rest, const Eigen::AlignedBox3d& box, const Context& context) {
  const Eigen::AlignedBox3d wide(box.min().array() - rest.size, box.max().array() + rest.size);
  Flags is_near(rest.triangles.rows(), 0);
  parallel_blocks(
      is_near.size(),
      [&](std::size_t begin, std::size_t end) {
        for (std::size_t t = begin; t < end; ++t) {
          Eigen::AlignedBox3d triangle;
          for (const Index v : rest.triangles.row(static_cast<Eigen::Index>(t)))
            triangle.extend(rest.points.row(v).transpose());
          is_near[t] = wide.intersects(triangle);
        }
      },
      context, 4096);
  std::vector<Index> near;
  for (std::size_t t = 0; t < is_near.size(); ++t)
    if (is_near[t]) near.push_back(static_cast<Index>(t));
  return near;
}

std::vector<Probe> make_probes(const Rest& rest, const EditedMesh& mesh, const std::vector<Index>& near,
                               const std::vector<Index>& vertices) {
  std::vector<Probe> probes(vertices.size());
  std::vector<Index> probe_at(static_cast<std::size_t>(rest.points.rows()), -1);
  for (std::size_t k = 0; k < vertices.size(); ++k) {
    probes[k].vertex = vertices[k];
    probe_at[vertices[k]] = static_cast<Index>(k);
  }
  std::vector<int> sides(probes.size(), 0);
  for (const Index t : near)
    for (int c = 0; c < 3; ++c) {
      const Index number = probe_at[rest.triangles(t, c)];
      if (number < 0) continue;
      const Vector3d next = rest.corner(t, (c + 1) % 3) - rest.corner(t, c);
      const Vector3d last = rest.corner(t, (c + 2) % 3) - rest.corner(t, c);
      probes[number].inward -= next.cross(last);
      const auto edited = [&](int k) -> Vector3d {
        return (mesh.edited.row(rest.triangles(t, k)) - mesh.edited.row(rest.triangles(t, c))).transpose() /
               rest.size;
      };
      probes[number].inward_edited -= edited((c + 1) % 3).cross(edited((c + 2) % 3));
      probes[number].edge += next.norm() + last.norm();
      sides[number] += 2;
    }
  for (std::size_t k = 0; k < probes.size(); ++k) {
    probes[k].inward = probes[k].inward.stableNormalized();
    if (sides[k] > 0) probes[k].edge /= sides[k];
  }
  return probes;
}

/// Returns the triangles near the rays. Widths are at most 1.
std::vector<Index> triangles_near_rays(const Rest& rest, const std::vector<Probe>& probes,
                                       const std::vector<Index>& triangles, const Context& context) {
  constexpr double length = 1.001;
  constexpr std::uint64_t cell_count = std::uint64_t{1} << 27;  // 16 MiB
  Eigen::AlignedBox3d rays, points;
  for (const Probe& probe : probes) {
    const Vector3d from = rest.at(probe.vertex);
    if (from.allFinite()) rays.extend(from).extend(from + length * probe.inward);
  }
  for (Eigen::Index v = 0; v < rest.points.rows(); ++v)
    if (const Vector3d point = rest.at(static_cast<Index>(v)); point.allFinite()) points.extend(point);
  const Eigen::AlignedBox3d box = rays.intersection(points);
  if (box.isEmpty()) return {};
  CrossedCells crossed(box, cell_count);
  parallel_blocks(
      probes.size(),
      [&](std::size_t begin, std::size_t end) {
        for (std::size_t k = begin; k < end; ++k) {
          const Vector3d from = rest.at(probes[k].vertex);
          if (from.allFinite()) crossed.add_segment(from, from + length * probes[k].inward);
        }
      },
      context, 64);
  Flags is_near(triangles.size(), 0);
  parallel_blocks(
      triangles.size(),
      [&](std::size_t begin, std::size_t end) {
        for (std::size_t k = begin; k < end; ++k) {
          Eigen::AlignedBox3d triangle;
          for (int c = 0; c < 3; ++c) triangle.extend(rest.corner(triangles[k], c));
          is_near[k] = crossed.may_meet(triangle);
        }
      },
      context, 4096);
  std::vector<Index> near;
  for (std::size_t k = 0; k < triangles.size(); ++k)
    if (is_near[k]) near.push_back(triangles[k]);
  return near;
}

}  // namespace

Narrowest find_narrowest(const EditedMesh& mesh, std::span<const std::uint8_t> is_free,
                         const Context& context) {
  const std::vector<Index> vertices = choose_vertices(is_free);
  Eigen::AlignedBox3d box;
  for (const Index v : vertices)
    if (mesh.rest.row(v).allFinite()) box.extend(mesh.rest.row(v).transpose());
  const double size = box.isEmpty() ? 0 : box.sizes().stableNorm();
  if (!(size > 0) || !std::isfinite(size)) return {};
  const Rest rest{mesh.rest, mesh.triangles, box.center(), size};
  context.throw_if_stopped();
  std::vector<Index> near = triangles_near(rest, box, context);
  const std::vector<Probe> probes = make_probes(rest, mesh, near, vertices);
  if (near.size() >= many_triangles) near = triangles_near_rays(rest, probes, near, context);
  std::vector<RayTriangle> traced(near.size());
  parallel_blocks(
      near.size(),
      [&](std::size_t begin, std::size_t end) {
        for (std::size_t k = begin; k < end; ++k)
          for (int c = 0; c < 3; ++c)
            traced[k][static_cast<std::size_t>(c)] = rest.corner(near[k], c).cast<float>();
      },
      context, 4096);
  const RayTracer tracer(traced, context);
  context.throw_if_stopped();

  std::vector<double> widths(probes.size(), std::numeric_limits<double>::infinity());
  const auto measure = [&](std::size_t k) {
    constexpr double clearance = 0.01;  // × the edge, so that the triangles around the vertex are not met
    const Probe& probe = probes[k];
    const Vector3d from = rest.at(probe.vertex), origin = from + clearance * probe.edge * probe.inward;
    if (probe.inward.isZero(0) || !origin.allFinite()) return;
    const auto hit = tracer.first_hit(origin.cast<float>(), probe.inward.cast<float>());
    if (!hit) return;
    const Index t = near[hit->triangle];
    const double u = hit->u, v = hit->v;
    const Vector3d a = rest.corner(t, 0), b = rest.corner(t, 1), c = rest.corner(t, 2);
    const double width = ((1 - u - v) * a + u * b + v * c - from).norm();
    const Vector3d normal = (b - a).cross(c - a).stableNormalized();
    if (normal.dot(probe.inward) < least_cosine || width < probe.edge || width > 1) return;
    const auto away = [&](int k) -> Vector3d {  // of the opposite triangle's corner from the vertex
      return (mesh.edited.row(mesh.triangles(t, k)) - mesh.edited.row(probe.vertex)).transpose() / size;
    };
    const Vector3d across = (1 - u - v) * away(0) + u * away(1) + v * away(2);
    const Vector3d edited_normal = (away(1) - away(0)).cross(away(2) - away(0));
    const bool is_turned_through = across.dot(probe.inward_edited) < 0 && across.dot(edited_normal) < 0;
    const double ratio = is_turned_through ? 0 : across.norm() / width;
    if (std::isfinite(ratio)) widths[k] = ratio;
  };
  parallel_blocks(
      probes.size(),
      [&](std::size_t begin, std::size_t end) {
        for (std::size_t k = begin; k < end; ++k) measure(k);
      },
      context);
  Narrowest narrowest{.width = std::numeric_limits<double>::infinity()};
  for (std::size_t k = 0; k < probes.size(); ++k)
    if (widths[k] < narrowest.width) narrowest = {.width = widths[k], .vertex = probes[k].vertex};
  return narrowest.vertex < 0 ? Narrowest() : narrowest;
}

}  // namespace meshgraft
