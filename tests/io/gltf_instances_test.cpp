// An edit of one of several nodes that share a mesh changes that node alone.
#include <string>

#include <gtest/gtest.h>
#include <Eigen/Geometry>

#include <meshgraft/io/mesh_io.h>
#include <meshgraft/mesh/normals.h>

#include "gltf_builder.h"
#include "gltf_cases.h"
#include "temporary_folder.h"

namespace meshgraft::test {
namespace {

GltfBuilder instanced() {
  GltfBuilder b = rich_square();
  b.json["scenes"][0]["nodes"] = {0, 1, 2};
  b.add("nodes", {{"name", "second"}, {"mesh", 0}, {"translation", {10, 0, 0}}});
  b.add("nodes", {{"name", "third"}, {"mesh", 0}, {"rotation", {0, 0.6, 0, 0.8}}, {"translation", {0, 10, 0}}});
  return b;
}

TEST(Gltf, AnInstanceIsThereOncePerNode) {
  const TemporaryFolder folder;
  const Mesh mesh = folder.mesh("a.glb", instanced().glb());
  EXPECT_EQ(mesh.vertex_count(), 12);
  EXPECT_EQ(mesh.face_count(), 6);
}

TEST(Gltf, InstancesThatAgreeKeepSharing) {
  const TemporaryFolder folder;
  const std::string before = instanced().glb();
  Mesh mesh = folder.mesh("a.glb", before);
  const Eigen::Vector3d local(0.1, 0.2, 0.3);
  const Eigen::Vector3d turned = Eigen::Quaterniond(0.8, 0, 0.6, 0) * local;
  mesh.positions.row(1) += local.transpose();
  mesh.positions.row(5) += local.transpose();
  mesh.positions.row(9) += turned.transpose();
  const GlbParts after = parts_of(folder.written(mesh, "b.glb"));
  EXPECT_EQ(after.json["meshes"].size(), 1U);
  EXPECT_EQ(after.binary.size(), parts_of(before).binary.size());
  EXPECT_LT((read_mesh(folder / "b.glb").positions - mesh.positions).norm(), 1e-6);
}

TEST(Gltf, AnEditedInstanceGetsAMeshOfItsOwn) {
  const TemporaryFolder folder;
  const std::string before = instanced().glb(2);
  Mesh mesh = folder.mesh("a.glb", before);
  const Points rest = mesh.positions;
  for (Index v = 4; v < 8; ++v) mesh.positions(v, 2) += 0.25 * v;
  update_normals(mesh, rest);
  const GlbParts old_parts = parts_of(before);
  const std::string content = folder.written(mesh, "b.glb");
  const GlbParts after = parts_of(content);
  EXPECT_EQ(after.json["meshes"].size(), 2U);
  EXPECT_EQ(after.json["nodes"][1]["mesh"], 1);
  EXPECT_EQ(after.json["nodes"][0], old_parts.json["nodes"][0]);
  EXPECT_EQ(after.json["meshes"][0], old_parts.json["meshes"][0]);
  EXPECT_EQ(after.json["meshes"][1]["primitives"][0]["attributes"]["TEXCOORD_0"], 3);
  EXPECT_EQ(after.binary.substr(0, old_parts.binary.size()), old_parts.binary);
  EXPECT_NE(after.text.find("\"metallicFactor\": 0.1"), std::string::npos) << "the rest of the text stays";
  const Mesh again = read_mesh(folder / "b.glb");
  EXPECT_LT((again.positions - mesh.positions).norm(), 1e-6);
  EXPECT_EQ(folder.written(again, "c.glb"), content);
}

}  // namespace
}  // namespace meshgraft::test
