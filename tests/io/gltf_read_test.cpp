#include <algorithm>
#include <string>
#include <vector>

#include <gtest/gtest.h>
#include <Eigen/Geometry>

#include <meshgraft/mesh/normals.h>

#include "gltf_builder.h"
#include "gltf_cases.h"
#include "temporary_folder.h"

namespace meshgraft::test {
namespace {

TEST(Gltf, ReadsTheVerticesAndFacesOfEveryFile) {
  const TemporaryFolder folder;
  for (const GltfCase& c : gltf_cases()) {
    const Mesh mesh = folder.mesh("a.glb", c.builder.glb());
    EXPECT_EQ(mesh.vertex_count(), c.vertices) << c.name;
    EXPECT_EQ(mesh.face_count(), c.faces) << c.name;
    for (const double corner : mesh.faces.corners()) EXPECT_LT(corner, c.vertices) << c.name;
  }
}

TEST(Gltf, ShowsAttributesInTheirUsualUnits) {
  const TemporaryFolder folder;
  const Mesh mesh = folder.mesh("a.glb", rich_square().glb());
  const Attribute* uv = mesh.find_attribute(Domain::vertex, "uv");
  ASSERT_NE(uv, nullptr);
  EXPECT_EQ(uv->values, (std::vector<double>{0, 0, 1, 0, 1, 1, 0, 1}));  // v is counted from the bottom
  const Attribute* colour = mesh.find_attribute(Domain::vertex, "colour");
  ASSERT_NE(colour, nullptr);
  EXPECT_EQ(colour->components, 4);
  EXPECT_DOUBLE_EQ(colour->values[12], 0.2);
  EXPECT_NE(mesh.find_attribute(Domain::vertex, "tangent"), nullptr);
  EXPECT_NE(mesh.find_attribute(Domain::vertex, "uv_1"), nullptr);
  EXPECT_EQ(mesh.find_attribute(Domain::face, "material")->labels, std::vector<std::string>{"paint"});
  EXPECT_EQ(mesh.find_attribute(Domain::face, "object")->labels, std::vector<std::string>{"panel"});
}

TEST(Gltf, SeamsAreOfCorners) {
  const TemporaryFolder folder;
  const Mesh mesh = folder.mesh("a.glb", soup_with_seam().glb());
  EXPECT_NE(mesh.find_attribute(Domain::corner, "uv"), nullptr);
  EXPECT_EQ(mesh.find_attribute(Domain::vertex, "uv"), nullptr);
}

TEST(Gltf, NodesPlaceTheirMeshes) {
  const TemporaryFolder folder;
  const Mesh mesh = folder.mesh("a.glb", hierarchy().glb());
  Eigen::Affine3d world = Eigen::Affine3d::Identity();
  world.translate(Eigen::Vector3d(1, 2, 3));
  world.rotate(Eigen::Quaterniond(0.8, 0, 0, 0.6));
  world.scale(Eigen::Vector3d(2, 0.5, 1));
  world.translate(Eigen::Vector3d(5, 0, 0));
  world.scale(Eigen::Vector3d(-1, 1, 1));
  const std::vector<float> local = square_positions();
  // A mirror turns the triangles over, so the vertices come in another order.
  for (std::size_t v = 0; v < 4; ++v) {
    const Eigen::Vector3d p = world * Eigen::Vector3d(local[3 * v], local[3 * v + 1], local[3 * v + 2]);
    double nearest = 1;
    for (Index i = 0; i < 4; ++i) nearest = std::min(nearest, (mesh.positions.row(i).transpose() - p).norm());
    EXPECT_LT(nearest, 1e-14);
  }
  // Normals stay on the side of the faces.
  const Points faces = vertex_normals(mesh);
  const Attribute* normals = mesh.find_attribute(Domain::vertex, "normal");
  ASSERT_NE(normals, nullptr);
  for (Index v = 0; v < 4; ++v) {
    const Eigen::RowVector3d normal(normals->values[3 * v], normals->values[3 * v + 1],
                                    normals->values[3 * v + 2]);
    EXPECT_NEAR(normal.dot(faces.row(v)), 1, 1e-12);
  }
}

TEST(Gltf, TheNodeOfASkinnedMeshIsIgnored) {
  const TemporaryFolder folder;
  EXPECT_LE(folder.mesh("a.glb", skinned().glb()).positions.maxCoeff(), 1);
}

}  // namespace
}  // namespace meshgraft::test
