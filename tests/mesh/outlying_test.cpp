#include "mesh/outlying.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include <meshgraft/mesh/diagnostics.h>
#include <meshgraft/mesh/repair.h>

#include "shapes.h"
#include "support/defects.h"
#include "support/mesh_families.h"
#include "support/variants.h"

namespace meshgraft::test {
namespace {

constexpr double distances[] = {1e8, 1e12, 1e30, 1e100, 1e154, 1e200, 1e300};

std::vector<Index> middle_vertices(const Mesh& mesh, std::size_t count) {
  const auto face = mesh.faces[mesh.face_count() / 2];
  std::vector<Index> vertices(face.begin(), face.begin() + static_cast<std::ptrdiff_t>(count));
  std::ranges::sort(vertices);
  return vertices;
}

TEST(Outlying, VerticesAreFoundAtEveryDistance) {
  for (const TestMesh& family : mesh_families()) {
    const Mesh mesh = make_mesh(family.positions, family.triangles);
    EXPECT_TRUE(find_outlying(mesh).empty()) << family.name;
    for (const std::size_t count : {1, 2})
      for (const double distance_rel : distances) {
        if (4 * count >= static_cast<std::size_t>(family.size())) continue;  // as many as ordinary ones
        const double distance = distance_rel * std::min(family.box_diagonal(), 1e7);
        SCOPED_TRACE(family.name + " " + std::to_string(distance));
        const std::vector<Index> moved = middle_vertices(mesh, count);
        const OutlyingVertices found = find_outlying(with_outlying(mesh, moved, distance));
        EXPECT_EQ(found.far, moved);
        EXPECT_TRUE(found.too_large.empty());
        EXPECT_LT(found.radius, 10 * family.box_diagonal());
      }
  }
}

TEST(Outlying, AGroundAroundASmallModelIsSound) {
  // Four triangles around the origin, a billion times as large as the model.
  const Mesh model = shapes::torus(24, 12, true);
  const auto n = static_cast<Index>(model.vertex_count());
  Points positions(n + 5, 3);
  positions << model.positions, 0, 0, 0, 1e9, 0, 0, 0, 1e9, 0, -1e9, 0, 0, 0, -1e9, 0;
  Triangles triangles(4, 3);
  triangles << n, n + 1, n + 2, n, n + 2, n + 3, n, n + 3, n + 4, n, n + 4, n + 1;
  Mesh scene = model;
  scene.positions = positions;
  for (const auto face : triangles.rowwise()) scene.faces.push_back(std::vector<Index>{face[0], face[1], face[2]});
  EXPECT_TRUE(find_outlying(scene).empty());
}

// Neither the unit of length nor the origin matters.
TEST(Outlying, SizesAndPlacesDoNotMatter) {
  const Mesh torus = shapes::torus(24, 12, true);
  for (const double scale : {1e-200, 1e-30, 1e-3, 1e30, 1e50})
    for (const double origin : {0.0, 1e3, -1e6}) {
      Mesh mesh = torus;
      mesh.positions = scale * (mesh.positions.array() + origin).matrix();
      EXPECT_TRUE(find_outlying(mesh).empty()) << scale << " " << origin;
      EXPECT_EQ(find_outlying(with_outlying(mesh, {7}, 1e9 * scale)).far, std::vector<Index>{7});
    }
}

// Models with long parts are sound: a spike, a plain on which a small model stands, terrain that grows coarser
// with the distance, and components far apart.
TEST(Outlying, LongModelsAreSound) {
  const Mesh torus = shapes::torus(24, 12, true);
  EXPECT_TRUE(find_outlying(with_outlying(torus, {7}, 1e5)).empty()) << "a spike";
  Mesh plain = shapes::polygons({{-1, -1, 0}, {1, -1, 0}, {1, 1, 0}, {-1, 1, 0}}, {{0, 1, 2}, {0, 2, 3}});
  for (const double size : {1e5, 1e9, 1e30}) {
    Mesh large = plain;
    large.positions *= size;
    EXPECT_TRUE(find_outlying(shapes::together({torus, large})).empty()) << "a plain of " << size;
  }
  Mesh there = torus;
  there.positions.rowwise() += Eigen::RowVector3d(1e12, 0, 0);
  EXPECT_TRUE(find_outlying(shapes::together({torus, torus, torus, torus, there})).empty()) << "far apart";

  // Rings of four vertices, each ten times as far out as the one before, around a fine one.
  std::vector<std::vector<double>> positions;
  std::vector<std::vector<Index>> faces;
  for (int ring = 0; ring < 60; ++ring) {
    const double r = ring < 48 ? 1 + ring / 48.0 : 2 * std::pow(10, ring - 47);
    for (const auto& [x, y] : {std::pair(1, 0), std::pair(0, 1), std::pair(-1, 0), std::pair(0, -1)})
      positions.push_back({x * r, y * r, 0});
    for (Index k = 0; ring > 0 && k < 4; ++k) {
      const Index a = 4 * (ring - 1) + k, b = 4 * (ring - 1) + (k + 1) % 4;
      faces.push_back({a, a + 4, b + 4, b});
    }
  }
  Mesh terrain;
  terrain.positions.resize(static_cast<Eigen::Index>(positions.size()), 3);
  for (std::size_t v = 0; v < positions.size(); ++v)
    terrain.positions.row(static_cast<Eigen::Index>(v)) << positions[v][0], positions[v][1], positions[v][2];
  for (const auto& face : faces) terrain.faces.push_back(face);
  EXPECT_TRUE(find_outlying(terrain).empty());
}

// Beyond 1e60 no command works, whichever vertices have such coordinates.
TEST(Outlying, CoordinatesThatAreTooLargeAreNamed) {
  const Mesh torus = shapes::torus(24, 12, true);
  Mesh large = torus;
  large.positions *= 1e61;
  EXPECT_EQ(find_outlying(large).too_large.size(), 288u);
  EXPECT_TRUE(find_outlying(large).far.empty());
  ASSERT_TRUE(check_mesh(large).find(FindingKind::coordinate_too_large));
  EXPECT_FALSE(repair(large).changed()) << "scaling is the remedy";
  EXPECT_THROW(require_sound(check_mesh(large), large), Error);

  Mesh with_isolated = torus;
  with_isolated.positions.conservativeResize(289, 3);
  with_isolated.positions.row(288) << 1e59, 0, 0;
  EXPECT_TRUE(find_outlying(with_isolated).empty()) << "no equation contains it";
  with_isolated.positions.row(288) << 1e61, 0, 0;
  EXPECT_EQ(find_outlying(with_isolated).far, std::vector<Index>{288});
  const RepairResult kept = repair(with_isolated, {.remove_isolated = false});
  EXPECT_EQ(kept.mesh.vertex_count(), 288);
  EXPECT_TRUE(kept.find(RepairChangeKind::removed_outlying_vertex));
}

TEST(Outlying, NonFiniteVerticesAndBadIndicesAreLeftOut) {
  Mesh mesh = with_outlying(shapes::torus(24, 12, true), {7}, 1e20);
  mesh.positions(20, 1) = std::numeric_limits<double>::quiet_NaN();
  mesh.positions(21, 1) = std::numeric_limits<double>::infinity();
  mesh.faces.push_back(std::vector<Index>{7, 1, 9999});
  mesh.faces.push_back(std::vector<Index>{7, 7});
  EXPECT_EQ(find_outlying(mesh).far, std::vector<Index>{7});
  EXPECT_TRUE(find_outlying(Mesh()).empty());
}

// A repair takes nothing but these vertices: all others keep their positions.
TEST(Outlying, RepairRemovesThemAndKeepsTheirNeighbours) {
  for (const TestMesh& family : mesh_families()) {
    const Mesh mesh = make_mesh(family.positions, family.triangles);
    if (mesh.face_count() < 100) continue;
    for (const double distance_rel : distances) {
      const double distance = distance_rel * std::min(family.box_diagonal(), 1e7);
      SCOPED_TRACE(family.name + " " + std::to_string(distance));
      const std::vector<Index> moved = middle_vertices(mesh, 1);
      const RepairResult result = repair(with_outlying(mesh, moved, distance), {.remove_isolated = false});
      const RepairChange* removed = result.find(RepairChangeKind::removed_outlying_vertex);
      ASSERT_TRUE(removed);
      EXPECT_EQ(removed->indices, moved);
      for (const RepairChange& change : result.changes)
        EXPECT_TRUE(&change == removed || change.kind == RepairChangeKind::filled_hole) << name_of(change.kind);
      for (Index v = 0; v < mesh.vertex_count(); ++v) {
        const Index now = result.vertex.new_index[v];
        ASSERT_EQ(now < 0, v == moved.front()) << v;
        if (now < 0) continue;
        EXPECT_EQ(result.mesh.positions.row(now), mesh.positions.row(v));
      }
    }
  }
}

}  // namespace
}  // namespace meshgraft::test
