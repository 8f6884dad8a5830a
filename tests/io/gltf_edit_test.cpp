// An edit changes the bytes of positions and normals, and nothing else of a glTF file.
#include <set>
#include <string>

#include <gtest/gtest.h>

#include <meshgraft/io/mesh_io.h>

#include "gltf_builder.h"
#include "gltf_cases.h"
#include "io/file.h"
#include "temporary_folder.h"

namespace meshgraft::test {
namespace {

TEST(Gltf, WithoutAnEditComesBackByteForByte) {
  const TemporaryFolder folder;
  for (const GltfCase& c : gltf_cases()) {
    for (const int indent : {-1, 3}) {
      const std::string glb = c.builder.glb(indent);
      EXPECT_EQ(folder.written(folder.mesh("a.glb", glb), "b.glb"), glb) << c.name;
    }
    folder.file("a b.bin", c.builder.buffer);
    const std::string gltf = c.builder.gltf("a%20b.bin");
    EXPECT_EQ(folder.written(folder.mesh("a.gltf", gltf), "b.gltf"), gltf) << c.name;
  }
}

/// Returns the JSON without the bounds of accessors, which an edit may change.
Json without_bounds(Json json) {
  for (Json& accessor : json["accessors"]) {
    accessor.erase("min");
    accessor.erase("max");
  }
  return json;
}

/// Returns the accessors whose values an edit may change.
std::set<std::size_t> moved_accessors(const Json& json) {
  std::set<std::size_t> moved;
  for (const Json& mesh : json["meshes"])
    for (const Json& primitive : mesh["primitives"])
      for (const char* semantic : {"POSITION", "NORMAL", "TANGENT"})
        if (primitive["attributes"].contains(semantic))
          moved.insert(primitive["attributes"][semantic].get<std::size_t>());
  return moved;
}

TEST(Gltf, AnEditOfPositionsLeavesEverythingElse) {
  const TemporaryFolder folder;
  for (const GltfCase& c : gltf_cases()) {
    const std::string before = c.builder.glb(2);
    Mesh mesh = folder.mesh("a.glb", before);
    move_vertices(mesh);
    const std::string after = folder.written(mesh, "b.glb");
    const Mesh again = read_mesh(folder / "b.glb");
    const double tolerance = c.name == "quantised" ? 1e-4 : 1e-6;
    ASSERT_EQ(again.vertex_count(), mesh.vertex_count()) << c.name;
    EXPECT_LT((again.positions - mesh.positions).cwiseAbs().maxCoeff(), tolerance) << c.name;
    EXPECT_EQ(again.faces, mesh.faces) << c.name;

    const GlbParts old_parts = parts_of(before);
    const GlbParts new_parts = parts_of(after);
    EXPECT_EQ(without_bounds(new_parts.json), without_bounds(old_parts.json)) << c.name;
    EXPECT_EQ(new_parts.binary.size(), old_parts.binary.size()) << c.name;
    const std::set<std::size_t> moved = moved_accessors(old_parts.json);
    for (std::size_t a = 0; a < old_parts.json["accessors"].size(); ++a) {
      if (moved.contains(a)) continue;
      EXPECT_EQ(accessor_bytes(new_parts, a), accessor_bytes(old_parts, a)) << c.name;
    }
  }
}

TEST(Gltf, UnchangedVerticesKeepTheirBits) {
  const TemporaryFolder folder;
  for (const GltfCase& c : gltf_cases()) {
    if (c.name == "sparse") continue;
    const std::string before = c.builder.glb();
    Mesh mesh = folder.mesh("a.glb", before);
    mesh.positions.row(0) += Eigen::RowVector3d(0, 0, 0.125);
    const GlbParts old_parts = parts_of(before);
    const GlbParts new_parts = parts_of(folder.written(mesh, "b.glb"));
    const std::size_t position = old_parts.json["meshes"][0]["primitives"][0]["attributes"]["POSITION"];
    const std::string a = accessor_bytes(old_parts, position);
    const std::string b = accessor_bytes(new_parts, position);
    const std::size_t size = c.name == "quantised" ? 6 : 12;
    std::size_t changed = 0;
    for (std::size_t i = 0; i < a.size(); i += size) changed += a.substr(i, size) != b.substr(i, size) ? 1 : 0;
    EXPECT_EQ(changed, c.name == "seam" ? 2U : 1U) << c.name;
  }
}

TEST(Gltf, BoundsFollowAndTheirOtherNumbersKeepTheirText) {
  const TemporaryFolder folder;
  GltfBuilder b = plain_square();
  std::string text = b.gltf("a.bin");
  folder.file("a.bin", b.buffer);
  const std::size_t at = text.find("\"max\"");
  text.replace(text.find("1.0", at), 3, "1.000");
  Mesh mesh = folder.mesh("a.gltf", text);
  mesh.positions(2, 2) = 0.5;
  const std::string after = folder.written(mesh, "b.gltf");
  std::string expected = text;
  const std::size_t z = text.find("0.0", text.find("1.0", at + 14));
  expected.replace(z, 3, "0.5");
  expected.replace(expected.find("a.bin"), 5, "b.bin");
  EXPECT_EQ(after, expected);
  EXPECT_EQ(read_file(folder / "a.bin"), b.buffer);
  EXPECT_NE(read_file(folder / "b.bin"), b.buffer);
}

TEST(Gltf, AccessorsInOtherUseStay) {
  const TemporaryFolder folder;
  GltfBuilder b = plain_square();
  b.add("meshes", b.json["meshes"][0]);  // the same accessor in another mesh, elsewhere
  b.add("nodes", {{"mesh", 1}, {"translation", {5, 0, 0}}});
  b.json["scenes"][0]["nodes"].push_back(1);
  b.add("nodes", {{"mesh", 0}});  // in no scene
  const std::string before = b.glb();
  Mesh mesh = folder.mesh("a.glb", before);
  ASSERT_EQ(mesh.vertex_count(), 8);
  mesh.positions(0, 2) = 1;
  const GlbParts after = parts_of(folder.written(mesh, "b.glb"));
  EXPECT_EQ(accessor_bytes(after, 0), accessor_bytes(parts_of(before), 0));
  EXPECT_EQ(after.json["meshes"].size(), 3U);
  EXPECT_LT((read_mesh(folder / "b.glb").positions - mesh.positions).norm(), 1e-6);
}

TEST(Gltf, AccessorsOfExtensionsStay) {
  const TemporaryFolder folder;
  GltfBuilder b = plain_square();
  b.json["nodes"][0]["extensions"] = {{"EXT_mesh_gpu_instancing", {{"attributes", {{"TRANSLATION", 0}}}}}};
  const std::string before = b.glb();
  Mesh mesh = folder.mesh("a.glb", before);
  mesh.positions(0, 2) = 1;
  const GlbParts after = parts_of(folder.written(mesh, "b.glb"));
  EXPECT_EQ(accessor_bytes(after, 0), accessor_bytes(parts_of(before), 0));
  EXPECT_LT((read_mesh(folder / "b.glb").positions - mesh.positions).norm(), 1e-6);
}

TEST(Gltf, ValuesBeyondTheRangeOfIntegersBecomeFloats) {
  const TemporaryFolder folder;
  Mesh mesh = folder.mesh("a.glb", quantised().glb());
  mesh.positions.row(0) = Eigen::RowVector3d(-3, 0.1, 0);
  const WriteResult result = write_mesh(mesh, folder / "b.glb");
  ASSERT_EQ(result.notes.size(), 1U);
  EXPECT_EQ(result.notes[0].id(), "gltf.written_as_floats");
  EXPECT_LT((read_mesh(folder / "b.glb").positions - mesh.positions).cwiseAbs().maxCoeff(), 1e-7);
}

}  // namespace
}  // namespace meshgraft::test
