#include "surface.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include <Eigen/Geometry>

#include <meshgraft/core/error.h>
#include <meshgraft/mesh/topology.h>

#include "core/parallel.h"
#include "render/facts.h"

namespace meshgraft::render {

namespace {

std::vector<Vec3> corner_normals(const Points& positions, const Triangles& triangles,
                                 const RenderOptions& options, const Context& context) {
  const auto count = static_cast<std::size_t>(triangles.rows());
  std::vector<Vec3> flat(count);  // unit normal times twice the area
  parallel_blocks(
      count,
      [&](std::size_t begin, std::size_t end) {
        for (std::size_t t = begin; t < end; ++t) {
          const auto row = triangles.row(static_cast<Eigen::Index>(t));
          const Eigen::RowVector3d p = positions.row(row[0]), q = positions.row(row[1]),
                                   r = positions.row(row[2]);
          flat[t] = (q - p).cross(r - p).transpose().cast<float>();
        }
      },
      context, 4096);
  std::vector<Vec3> out(3 * count);
  const float limit = static_cast<float>(std::cos(options.crease_angle_deg * std::numbers::pi / 180.0));
  const IndexLists around = vertex_triangles(static_cast<Index>(positions.rows()), triangles, context);
  parallel_blocks(
      count,
      [&](std::size_t begin, std::size_t end) {
        for (std::size_t t = begin; t < end; ++t)
          for (int c = 0; c < 3; ++c) {
            Vec3 sum = flat[t];
            if (options.smooth)
              for (const Index other : around[triangles(static_cast<Eigen::Index>(t), c)]) {
                const Vec3& n = flat[other];
                if (static_cast<std::size_t>(other) != t && n.dot(flat[t]) > limit * n.norm() * flat[t].norm())
                  sum += n;
              }
            out[3 * t + static_cast<std::size_t>(c)] = sum.normalized();
          }
      },
      context, 4096);
  return out;
}

// Marks the edges to draw; diagonals of polygons are not drawn.
std::vector<std::uint8_t> outlines(const Mesh& mesh, const Triangulation& triangulation) {
  std::vector<std::uint8_t> bits(triangulation.triangles.rows(), 0);
  for (std::size_t t = 0; t < bits.size(); ++t) {
    const auto face = mesh.faces[triangulation.face[t]];
    for (int c = 0; c < 3; ++c) {
      const Index a = triangulation.triangles(static_cast<Eigen::Index>(t), (c + 1) % 3);
      const Index b = triangulation.triangles(static_cast<Eigen::Index>(t), (c + 2) % 3);
      for (std::size_t k = 0; k < face.size(); ++k)
        if (face[k] == a && face[(k + 1) % face.size()] == b) bits[t] |= static_cast<std::uint8_t>(1 << c);
    }
  }
  return bits;
}

/// Leaves out triangles with a vertex that is not finite. Puts such vertices where a finite one is, so that the
/// camera fits to the others.
void keep_finite(Points& positions, Triangulation& triangulation) {
  if (positions.allFinite()) return;
  Eigen::Index finite = 0;
  while (finite < positions.rows() && !positions.row(finite).allFinite()) ++finite;
  Eigen::Index kept = 0;
  for (Eigen::Index t = 0; t < triangulation.triangles.rows(); ++t) {
    const auto corners = triangulation.triangles.row(t);
    if (!std::all_of(corners.begin(), corners.end(), [&](Index v) { return positions.row(v).allFinite(); }))
      continue;
    triangulation.triangles.row(kept) = corners;
    triangulation.face[kept++] = triangulation.face[t];
  }
  triangulation.triangles.conservativeResize(kept, Eigen::NoChange);
  triangulation.face.resize(kept);
  if (kept == 0) return;
  for (Eigen::Index v = 0; v < positions.rows(); ++v)
    if (!positions.row(v).allFinite()) positions.row(v) = positions.row(finite).eval();
}

}  // namespace

Surface prepare(const Shape& shape, const RenderOptions& options, const Context& context) {
  const Mesh& mesh = *shape.mesh;
  if (shape.colours.rows() > 0 && shape.colours.rows() != mesh.positions.rows())
    throw Error(
        facts::render::ColoursIncomplete{.colours = shape.colours.rows(), .vertices = mesh.vertex_count()});
  Triangulation triangulation = triangulate(mesh);
  Surface surface;
  surface.positions = mesh.positions.rowwise() + shape.offset.transpose();
  keep_finite(surface.positions, triangulation);
  surface.triangles = triangulation.triangles;
  surface.corner_normals = corner_normals(surface.positions, surface.triangles, options, context);
  if (options.wireframe) surface.outlines = outlines(mesh, triangulation);
  for (Eigen::Index v = 0; v < shape.colours.rows(); ++v)
    surface.colours.push_back(shape.colours.row(v).transpose().cast<float>());
  return surface;
}

}  // namespace meshgraft::render
