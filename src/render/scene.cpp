#include "scene.h"

#include <algorithm>
#include <utility>

#include <meshgraft/core/error.h>

#include "render/facts.h"

namespace meshgraft::render {

namespace {

// Marks the edges to draw; diagonals of polygons are not drawn.
void append_outlines(const Mesh& mesh, const Triangulation& triangulation,
                     std::vector<std::uint8_t>& outlines) {
  for (Eigen::Index t = 0; t < triangulation.triangles.rows(); ++t) {
    const auto face = mesh.faces[triangulation.face[t]];
    std::uint8_t bits = 0;
    for (int c = 0; c < 3; ++c) {
      const Index a = triangulation.triangles(t, (c + 1) % 3), b = triangulation.triangles(t, (c + 2) % 3);
      for (std::size_t k = 0; k < face.size(); ++k)
        if (face[k] == a && face[(k + 1) % face.size()] == b) bits |= static_cast<std::uint8_t>(1 << c);
    }
    outlines.push_back(bits);
  }
}

void require_all_colours(const Shape& shape) {
  if (shape.colours.rows() > 0 && shape.colours.rows() != shape.mesh->positions.rows())
    throw Error(facts::render::ColoursIncomplete{.colours = shape.colours.rows(),
                                                 .vertices = shape.mesh->vertex_count()});
}

void append_colours(const Shape& shape, std::vector<Vec3>& colours) {
  if (shape.colours.rows() == 0) colours.insert(colours.end(), shape.mesh->positions.rows(), clay);
  for (const auto& colour : shape.colours.rowwise()) colours.push_back(colour.transpose().cast<float>());
}

/// Leaves out triangles with a vertex that is not finite.
void keep_finite(Scene& scene) {
  Flags is_finite;
  for (const auto& [positions, offset] : scene.parts)
    for (Eigen::Index v = 0; v < positions->rows(); ++v)
      is_finite.push_back((positions->row(v) + offset).allFinite());
  if (std::ranges::find(is_finite, 0) == is_finite.end()) return;
  Eigen::Index kept = 0;
  for (Eigen::Index t = 0; t < scene.triangles.rows(); ++t) {
    const Eigen::RowVector3<Index> corners = scene.triangles.row(t);
    if (!std::all_of(corners.begin(), corners.end(),
                     [&](Index v) { return is_finite[static_cast<std::size_t>(v)] != 0; }))
      continue;
    if (!scene.outlines.empty())
      scene.outlines[static_cast<std::size_t>(kept)] = scene.outlines[static_cast<std::size_t>(t)];
    scene.triangles.row(kept++) = corners;
  }
  scene.triangles.conservativeResize(kept, Eigen::NoChange);
  if (!scene.outlines.empty()) scene.outlines.resize(static_cast<std::size_t>(kept));
}

/// Appends the triangles of a shape, whose vertices follow those of the parts.
void append_triangles(Triangles triangles, Scene& scene) {
  if (scene.parts.empty()) {
    scene.triangles = std::move(triangles);
    return;
  }
  const Eigen::Index count = scene.triangles.rows();
  const auto first_vertex = static_cast<Index>(scene.vertex_count());
  scene.triangles.conservativeResize(count + triangles.rows(), Eigen::NoChange);
  scene.triangles.bottomRows(triangles.rows()) = triangles.array() + first_vertex;
}

}  // namespace

Scene make_scene(std::span<const Shape> shapes, const RenderOptions& options) {
  const bool coloured =
      std::ranges::any_of(shapes, [](const Shape& shape) { return shape.colours.rows() > 0; });
  Scene scene;
  for (const Shape& shape : shapes) {
    require_all_colours(shape);
    Triangulation triangulation = triangulate(*shape.mesh);
    if (triangulation.triangles.rows() == 0) continue;
    if (coloured) append_colours(shape, scene.colours);
    if (options.wireframe) append_outlines(*shape.mesh, triangulation, scene.outlines);
    append_triangles(std::move(triangulation.triangles), scene);
    scene.parts.push_back({&shape.mesh->positions, shape.offset.transpose()});
  }
  keep_finite(scene);
  if (scene.triangles.rows() == 0) throw Error(facts::render::NoFace{});
  return scene;
}

}  // namespace meshgraft::render
