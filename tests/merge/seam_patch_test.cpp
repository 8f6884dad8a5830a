#include "merge/seam_patch.h"

#include <algorithm>
#include <map>
#include <set>

#include <gtest/gtest.h>

#include <meshgraft/mesh/topology.h>

#include "merge/seam_scenes.h"
#include "mesh/shapes.h"

namespace meshgraft {
namespace {

TEST(SeamPatch, HoldsTheFacesWithinItsRingsOfTheStrip) {
  for (const test::SeamScene& scene : test::seam_scenes(0.2))
    for (const int rings : {1, 2, 3, 20}) {
      SCOPED_TRACE(scene.name);
      const SeamPatch patch = make_seam_patch(scene.mesh, scene.layout, rings);
      std::vector<Index> strip;
      for (Index v = 0; v < scene.mesh.vertex_count(); ++v)
        if (scene.is_on_strip(v)) strip.push_back(v);
      const IndexLists around = vertex_rings(scene.mesh.vertex_count(), scene.mesh.faces);
      EXPECT_EQ(patch.vertex, grow_rings(strip, rings, around));
      Index faces = 0;
      const std::vector<Index> inner = grow_rings(strip, rings - 1, around);
      for (Index f = 0; f < scene.mesh.face_count(); ++f) {
        const auto face = scene.mesh.faces[f];
        faces += std::any_of(face.begin(), face.end(),
                             [&](Index v) { return std::binary_search(inner.begin(), inner.end(), v); });
      }
      EXPECT_EQ(patch.triangles.rows(), faces);
      for (std::size_t k = 0; k < patch.vertex.size(); ++k) {
        EXPECT_EQ(patch.points.row(static_cast<Eigen::Index>(k)), scene.mesh.positions.row(patch.vertex[k]));
        EXPECT_EQ(patch.of[k], scene.layout.side_of_vertex(patch.vertex[k]));
        const std::vector<Index> nearer = grow_rings(strip, patch.ring[k] - 1, around);
        EXPECT_TRUE(std::binary_search(nearer.begin(), nearer.end(), patch.vertex[k]));
        if (patch.ring[k] > 1) {
          const std::vector<Index> nearest = grow_rings(strip, patch.ring[k] - 2, around);
          EXPECT_FALSE(std::binary_search(nearest.begin(), nearest.end(), patch.vertex[k]));
        }
      }
    }
}

TEST(SeamPatch, KnowsTheSideOfEachTriangle) {
  for (const test::SeamScene& scene : test::seam_scenes(0)) {
    const SeamPatch patch = make_seam_patch(scene.mesh, scene.layout, 20);  // the whole mesh, in its order
    ASSERT_EQ(patch.triangles.rows(), scene.mesh.face_count()) << scene.name;
    for (Index f = 0; f < scene.mesh.face_count(); ++f) {
      EXPECT_EQ(patch.side[f], scene.layout.side_of_face(f));
      EXPECT_TRUE(
          std::equal(scene.mesh.faces[f].begin(), scene.mesh.faces[f].end(), patch.triangles.row(f).begin()));
    }
  }
}

TEST(SeamPatch, MarksTheBoundaryOfMeshAndPatch) {
  for (const test::SeamScene& scene : test::seam_scenes(0))
    for (const int rings : {2, 20}) {
      const SeamPatch patch = make_seam_patch(scene.mesh, scene.layout, rings);
      std::set<Index> border;
      for (const auto& loop : boundary_loops(make_mesh(patch.points, patch.triangles)))
        border.insert(loop.begin(), loop.end());
      for (std::size_t k = 0; k < patch.vertex.size(); ++k)
        EXPECT_EQ(patch.on_border[k] != 0, border.contains(static_cast<Index>(k))) << scene.name;
    }
}

TEST(SeamEdges, AreTheEdgesOfTwoTrianglesOnce) {
  for (const test::SeamScene& scene : test::seam_scenes(0.3)) {
    SCOPED_TRACE(scene.name);
    const SeamPatch patch = make_seam_patch(scene.mesh, scene.layout, 3);
    std::map<std::array<Index, 2>, std::vector<Index>> beside;
    for (Index t = 0; t < static_cast<Index>(patch.triangles.rows()); ++t)
      for (int c = 0; c < 3; ++c) {
        const auto [a, b] = std::minmax({patch.triangles(t, c), patch.triangles(t, (c + 1) % 3)});
        beside[{a, b}].push_back(t);
      }
    std::erase_if(beside, [](const auto& edge) { return edge.second.size() != 2; });
    const std::vector<SeamEdge> edges = inner_edges(patch);
    EXPECT_EQ(edges.size(), beside.size());
    for (const SeamEdge& edge : edges) {
      const auto& triangles = beside.at(edge.ends);
      EXPECT_EQ((std::set{triangles[0], triangles[1]}), (std::set{edge.triangles[0], edge.triangles[1]}));
    }
  }
}

TEST(SeamEdges, AreFlatInAPlaneAndRightAngledOnACube) {
  for (const test::SeamScene& scene : test::seam_scenes(0)) {
    if (scene.name != "flat ring") continue;
    for (const SeamEdge& edge : inner_edges(make_seam_patch(scene.mesh, scene.layout, 3)))
      EXPECT_NEAR(edge.dihedral_deg, 0, 1e-9);
  }
  const Mesh cube = shapes::cube();
  const SeamPatch patch =
      make_seam_patch(cube, {.target_vertices = 8, .target_faces = 5, .source_faces = 0}, 3);
  int flat = 0, right = 0;
  for (const SeamEdge& edge : inner_edges(patch)) (edge.dihedral_deg < 45 ? flat : right) += 1;
  EXPECT_EQ(flat, 6);    // the diagonals of the faces
  EXPECT_EQ(right, 12);  // the edges of the cube
  for (const SeamEdge& edge : inner_edges(patch))
    EXPECT_NEAR(edge.dihedral_deg, edge.dihedral_deg < 45 ? 0 : 90, 1e-9);
}

}  // namespace
}  // namespace meshgraft
