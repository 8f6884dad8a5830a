// Buffers stay within the GLB, beside the glTF file or in data URIs.
#include <cstdint>
#include <cstring>
#include <filesystem>
#include <string>

#include <gtest/gtest.h>

#include <meshgraft/io/mesh_io.h>

#include "gltf_builder.h"
#include "gltf_cases.h"
#include "io/file.h"
#include "temporary_folder.h"

namespace meshgraft::test {
namespace {

TEST(Gltf, DataUrisAreEncodedAgain) {
  const TemporaryFolder folder;
  const GltfBuilder b = plain_square();
  const std::string head = "data:application/octet-stream;base64,";
  const std::string zeros =
      head + "AAAAAAAAAAAAAAAAAACAPwAAAAAAAAAAAACAPwAAgD8AAAAAAAAAAAAAgD8AAAAAAAABAAIAAAACAAMA";
  const std::string before = b.gltf(zeros);
  Mesh mesh = folder.mesh("a.gltf", before);
  ASSERT_EQ(mesh.vertex_count(), 4);
  EXPECT_EQ(folder.written(mesh, "b.gltf"), before);
  move_vertices(mesh);
  const Json after = Json::parse(folder.written(mesh, "b.gltf"));
  EXPECT_TRUE(after["buffers"][0]["uri"].get<std::string>().starts_with(head));
  EXPECT_LT((read_mesh(folder / "b.gltf").positions - mesh.positions).norm(), 1e-6);
  EXPECT_EQ(folder.entry_count(), 2U);
}

// A buffer of another name may serve other files, so it stays as it is even if the mesh is written in place.
TEST(Gltf, LeavesBuffersOfOtherNamesAlone) {
  const TemporaryFolder folder;
  const GltfBuilder b = plain_square();
  folder.file("shared.bin", b.buffer);
  Mesh mesh = folder.mesh("a.gltf", b.gltf("shared.bin"));
  mesh.positions(2, 2) = 0.5;
  folder.written(mesh, "a.gltf");
  EXPECT_EQ(read_file(folder / "shared.bin"), b.buffer);
  Mesh again = read_mesh(folder / "a.gltf");
  EXPECT_EQ(again.positions, mesh.positions);
  again.positions(2, 2) = 0.25;
  folder.written(again, "a.gltf");  // a.gltf now has a buffer of its own
  EXPECT_FALSE(std::filesystem::exists(folder / "a_2.bin"));
  EXPECT_EQ(read_mesh(folder / "a.gltf").positions(2, 2), 0.25);
}

TEST(Gltf, NeverReplacesTheBufferOfItsInput) {
  const TemporaryFolder folder;
  const GltfBuilder b = plain_square();
  folder.file("out.bin", b.buffer);  // the input's buffer has the name that the output's would get
  Mesh mesh = folder.mesh("in.gltf", b.gltf("out.bin"));
  move_vertices(mesh);
  const WriteResult result = write_mesh(mesh, folder / "out.gltf");
  EXPECT_EQ(read_file(folder / "out.bin"), b.buffer);
  ASSERT_EQ(result.files.size(), 2U);
  EXPECT_EQ(result.files[1].filename(), "out_2.bin");
  write_mesh(mesh, folder / "out.gltf");
  EXPECT_EQ(folder.entry_count(), 4U) << "a buffer of the file that is replaced is replaced";
}

TEST(Gltf, GoesFromOneContainerToTheOther) {
  const TemporaryFolder folder;
  const std::string glb = rich_square().glb();
  Mesh mesh = folder.mesh("a.glb", glb);
  move_vertices(mesh);
  write_mesh(mesh, folder / "b.gltf");
  EXPECT_TRUE(std::filesystem::exists(folder / "b.bin"));
  const Mesh split = read_mesh(folder / "b.gltf");
  write_mesh(split, folder / "c.glb");
  const Mesh joined = read_mesh(folder / "c.glb");
  EXPECT_EQ(joined.positions, split.positions);
  EXPECT_EQ(joined.faces, mesh.faces);
  write_mesh(mesh, folder / "d.glb");
  EXPECT_EQ(parts_of(read_file(folder / "c.glb")).binary, parts_of(read_file(folder / "d.glb")).binary);
}

TEST(Gltf, AnotherFolderGetsTheBuffersAndRefersToTheImages) {
  const TemporaryFolder folder;
  GltfBuilder b = plain_square();
  b.add("images", {{"uri", "textures/a%20b.png"}});
  folder.file("a.bin", b.buffer);
  std::filesystem::create_directory(folder / "sub");
  const Mesh mesh = folder.mesh("a.gltf", b.gltf("a.bin"));
  const WriteResult result = write_mesh(mesh, folder / "sub" / "o.gltf");
  const Json json = Json::parse(read_file(folder / "sub" / "o.gltf"));
  EXPECT_EQ(json["images"][0]["uri"], "../textures/a%20b.png");
  EXPECT_EQ(json["buffers"][0]["uri"], "o.bin");
  EXPECT_EQ(read_file(folder / "sub" / "o.bin"), b.buffer);
  ASSERT_EQ(result.notes.size(), 1U);
  EXPECT_EQ(result.notes[0].id(), "gltf.images_stay");
}

TEST(Gltf, KeepsChunksItDoesNotKnow) {
  const TemporaryFolder folder;
  std::string glb = plain_square().glb();
  GltfBuilder::append_u32(glb, 4);
  glb += "ODD.data";
  const auto size = static_cast<std::uint32_t>(glb.size());
  std::memcpy(glb.data() + 8, &size, 4);
  Mesh mesh = folder.mesh("a.glb", glb);
  move_vertices(mesh);
  EXPECT_TRUE(folder.written(mesh, "b.glb").ends_with("ODD.data"));
  EXPECT_EQ(read_mesh(folder / "b.glb").vertex_count(), 4);
}

}  // namespace
}  // namespace meshgraft::test
