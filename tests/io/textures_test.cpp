// Tests which pictures are found for a mesh's materials.
#include <filesystem>
#include <fstream>
#include <string>

#include <gtest/gtest.h>

#include <meshgraft/io/mesh_io.h>

#include "io/file.h"
#include "io/gltf/images.h"
#include "io/textures.h"
#include "mesh/join.h"
#include "temporary_folder.h"

namespace meshgraft::test {
namespace {

namespace fs = std::filesystem;

void put_file(const fs::path& file, const std::string& content) {
  fs::create_directories(file.parent_path());
  std::ofstream(file, std::ios::binary) << content;
}

Mesh triangle_of(const fs::path& file, const std::string& library, const std::string& material) {
  put_file(file, "mtllib " + library + "\nv 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0 0\nvt 1 0\nvt 0 1\nusemtl " +
                     material + "\nf 1/1 2/2 3/3\n");
  return read_mesh(file);
}

std::string gltf_with(const std::string& image) {
  return R"({"asset": {"version": "2.0"}, "scene": 0, "scenes": [{"nodes": [0]}], "nodes": [{"mesh": 0}],
    "meshes": [{"primitives": [{"attributes": {"POSITION": 0}, "material": 0}]}],
    "materials": [{"name": "skin", "pbrMetallicRoughness": {"baseColorTexture": {"index": 0}}}],
    "textures": [{"source": 0}], "images": [)" +
         image + R"(],
    "accessors": [{"bufferView": 0, "componentType": 5126, "count": 3, "type": "VEC3", "min": [0, 0, 0],
                   "max": [1, 1, 0]}],
    "bufferViews": [{"buffer": 0, "byteLength": 36}, {"buffer": 0, "byteOffset": 12, "byteLength": 4},
                    {"buffer": 0, "byteOffset": 30, "byteLength": 40}],
    "buffers": [{"byteLength": 36,
                 "uri": "data:application/octet-stream;base64,AAAAAAAAAAAAAAAAAACAPwAAAAAAAAAAAAAAAAAAgD8AAAAA"}]})";
}

TEST(Textures, AreThoseOfTheLibrary) {
  const TemporaryFolder folder;
  put_file(
      folder / "looks/one.mtl",
      "newmtl other\nmap_Kd missing.png\nnewmtl skin\nKd 1 1 1\nmap_Bump bump.png\nmap_Kd -s 2 2 a b.png\n");
  put_file(folder / "looks/a b.png", "picture");
  put_file(folder / "looks/bump.png", "bumps");
  const auto textures = textures_of(triangle_of(folder / "model.obj", "looks/one.mtl", "skin"));
  ASSERT_EQ(textures.size(), 1u);
  EXPECT_EQ(textures[0].material, "skin");
  EXPECT_TRUE(fs::equivalent(textures[0].file, folder / "looks/a b.png"));
}

TEST(Textures, AreThoseOfTheCommentsOfAPly) {
  const TemporaryFolder folder;
  put_file(
      folder / "scan.ply",
      "ply\nformat ascii 1.0\ncomment TextureFile missing.png\ncomment TextureFile a b.png\nelement vertex 3\n"
      "property float x\nproperty float y\nproperty float z\nelement face 1\n"
      "property list uchar int vertex_indices\nproperty list uchar float texcoord\nproperty int texnumber\n"
      "end_header\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2 6 0 0 1 0 0 1 1\n");
  put_file(folder / "a b.png", "picture");
  const Mesh scan = read_mesh(folder / "scan.ply");
  const auto textures = textures_of(scan);
  ASSERT_EQ(textures.size(), 2u);
  EXPECT_EQ(textures[0].file, "");
  EXPECT_EQ(textures[1].material, "");
  EXPECT_TRUE(fs::equivalent(textures[1].file, folder / "a b.png"));
  const Attribute* number = scan.find_attribute(Domain::face, "texnumber");
  ASSERT_NE(number, nullptr);
  EXPECT_EQ(number->values, std::vector{1.0});
}

TEST(Textures, StayWithTheMaterialsOfJoinedMeshes) {
  const TemporaryFolder folder;
  for (const char* part : {"a", "b"}) {
    put_file(folder / part / "looks.mtl", "newmtl skin\nmap_Kd skin.png\n");
    put_file(folder / part / "skin.png", part);
  }
  const Mesh a = triangle_of(folder / "a/model.obj", "looks.mtl", "skin");
  const Mesh b = triangle_of(folder / "b/model.obj", "looks.mtl", "skin");
  const auto textures = textures_of(join(a, b).mesh);
  ASSERT_EQ(textures.size(), 2u);
  EXPECT_EQ(textures[0].material, "skin");
  EXPECT_EQ(read_file(textures[0].file), "a");
  EXPECT_EQ(textures[1].material, "skin_2");
  EXPECT_EQ(read_file(textures[1].file), "b");
}

TEST(Textures, AreReadFromAllPlacesThatGltfHasForThem) {
  const TemporaryFolder folder;
  put_file(folder / "a b.png", "picture");
  const auto of = [&](const std::string& image) {
    put_file(folder / "model.gltf", gltf_with(image));
    return textures_of(read_mesh(folder / "model.gltf"));
  };
  const auto beside = of(R"({"uri": "a%20b.png"})");
  ASSERT_EQ(beside.size(), 1u);
  EXPECT_EQ(beside[0].material, "skin");
  EXPECT_TRUE(fs::equivalent(beside[0].file, folder / "a b.png"));
  const auto within = of(R"({"bufferView": 1, "mimeType": "image/png"})");
  ASSERT_EQ(within.size(), 1u);
  EXPECT_EQ(*within[0].bytes, std::string("\0\0\x80\x3f", 4));
  const auto encoded = of(R"({"uri": "data:image/png;base64,cGljdHVyZQ=="})");
  ASSERT_EQ(encoded.size(), 1u);
  EXPECT_EQ(*encoded[0].bytes, "picture");
}

TEST(Textures, OfSeveralMaterialsShareTheirBytes) {
  const TemporaryFolder folder;
  std::string text = gltf_with(R"({"bufferView": 1, "mimeType": "image/png"})");
  const std::string materials = R"("materials": [)";
  const std::string one = R"({"pbrMetallicRoughness": {"baseColorTexture": {"index": 0}}}, )";
  text.insert(text.find(materials) + materials.size(), one + one);
  put_file(folder / "model.gltf", text);
  const Mesh mesh = read_mesh(folder / "model.gltf");
  const auto* document = dynamic_cast<const io::GltfDocument*>(mesh.source.get());
  ASSERT_NE(document, nullptr);
  const auto textures = io::textures_of(*document);
  ASSERT_EQ(textures.size(), 3u);
  EXPECT_EQ(textures[0].bytes, textures[1].bytes);
  EXPECT_EQ(textures[0].bytes, textures[2].bytes);
}

TEST(Textures, ThatAreMalformedAreLeftOut) {
  const TemporaryFolder folder;
  for (const char* image :
       {R"({"uri": "missing.png"})", R"({"uri": "https://example.org/a.png"})", R"({})", R"({"bufferView": 2})",
        R"({"bufferView": 9})", R"({"uri": "data:image/png;base64,!"})"}) {
    put_file(folder / "model.gltf", gltf_with(image));
    EXPECT_TRUE(textures_of(read_mesh(folder / "model.gltf")).empty()) << image;
  }
}

}  // namespace
}  // namespace meshgraft::test
