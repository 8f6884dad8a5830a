#include <meshgraft/mesh/mesh.h>

#include <gtest/gtest.h>

#include "mesh/shapes.h"

namespace meshgraft {
namespace {

TEST(Faces, KeepsCornersInOrder) {
  Faces faces;
  faces.reserve(2, 7);
  faces.push_back(std::vector<Index>{4, 2, 9});
  faces.push_back(std::vector<Index>{1, 0, 3, 7});
  ASSERT_EQ(faces.size(), 2);
  EXPECT_EQ(faces.corner_count(), 7);
  EXPECT_EQ(faces.first_corner(1), 3);
  EXPECT_EQ(std::vector<Index>(faces[1].begin(), faces[1].end()), (std::vector<Index>{1, 0, 3, 7}));
}

TEST(Mesh, FindsAttributesByDomainAndName) {
  Mesh mesh;
  mesh.attributes.push_back({.name = "normal", .domain = Domain::vertex});
  mesh.attributes.push_back({.name = "normal", .domain = Domain::corner});
  EXPECT_EQ(mesh.find_attribute(Domain::corner, "normal"), &mesh.attributes[1]);
  EXPECT_EQ(mesh.find_attribute(Domain::vertex, "normal"), &mesh.attributes[0]);
  EXPECT_EQ(mesh.find_attribute(Domain::face, "normal"), nullptr);
  EXPECT_EQ(mesh.find_attribute(Domain::vertex, "uv"), nullptr);
}

TEST(Mesh, MadeOfTrianglesIsItsOwnTriangulation) {
  const Mesh torus = shapes::torus();
  const Triangles triangles = triangulate(torus).triangles;
  const Mesh mesh = make_mesh(torus.positions, triangles);
  EXPECT_EQ(mesh.positions, torus.positions);
  EXPECT_EQ(mesh.face_count(), triangles.rows());
  EXPECT_EQ(triangulate(mesh).triangles, triangles);
}

}  // namespace
}  // namespace meshgraft
