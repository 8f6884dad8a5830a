#include <cmath>
#include <functional>
#include <limits>
#include <random>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include <meshgraft/core/error.h>
#include <meshgraft/io/mesh_io.h>
#include <meshgraft/mesh/diagnostics.h>

#include "expect_error.h"
#include "gltf_builder.h"
#include "temporary_folder.h"

namespace meshgraft::test {
namespace {

GltfBuilder square() {
  GltfBuilder b;
  const int positions = b.positions(square_positions());
  b.show({{"attributes", {{"POSITION", positions}}}, {"indices", b.accessor(square_indices(), "SCALAR")}});
  return b;
}

struct BadJson {
  std::string what;
  std::function<void(Json&)> spoil;
  std::vector<std::string> words;
};

TEST(GltfErrors, NameThePlaceInTheJson) {
  const TemporaryFolder folder;
  const std::vector<BadJson> cases = {
      {"version", [](Json& j) { j["asset"]["version"] = "1.0"; }, {"asset.version", "1.0"}},
      {"no version", [](Json& j) { j.erase("asset"); }, {"asset", "missing"}},
      {"draco",
       [](Json& j) { j["extensionsRequired"] = {"KHR_draco_mesh_compression"}; },
       {"extensionsRequired[0]", "draco"}},
      {"view range", [](Json& j) { j["bufferViews"][0]["byteLength"] = 1e9; }, {"bufferViews[0]", "beyond"}},
      {"view overflow",
       [](Json& j) { j["bufferViews"][0]["byteOffset"] = 9007199254740992ULL; },
       {"bufferViews[0]", "beyond"}},
      {"accessor overflow",
       [](Json& j) { j["accessors"][0]["byteOffset"] = 9007199254740992ULL; },
       {"accessors[0]", "beyond"}},
      {"count", [](Json& j) { j["accessors"][0]["count"] = 5; }, {"accessors[0]", "beyond"}},
      {"huge count", [](Json& j) { j["accessors"][0]["count"] = 2000000000; }, {"accessors[0]", "beyond"}},
      {"too huge count", [](Json& j) { j["accessors"][0]["count"] = 1e15; }, {"accessors[0].count", "large"}},
      {"zeros",
       [](Json& j) {
         j["accessors"][0].erase("bufferView");
         j["accessors"][0]["count"] = 2000000000;
       },
       {"accessors[0]", "no bufferView"}},
      {"reference",
       [](Json& j) { j["accessors"][0]["bufferView"] = 7; },
       {"accessors[0].bufferView", "7", "2 bufferViews"}},
      {"negative", [](Json& j) { j["accessors"][0]["bufferView"] = -1; }, {"accessors[0].bufferView"}},
      {"type", [](Json& j) { j["accessors"][0]["componentType"] = 5124; }, {"accessors[0].componentType"}},
      {"shape", [](Json& j) { j["accessors"][0]["type"] = "VEC2"; }, {"POSITION", "components"}},
      {"stride", [](Json& j) { j["bufferViews"][0]["byteStride"] = 4; }, {"bufferViews[0]", "byteStride"}},
      {"cycle", [](Json& j) { j["nodes"][0]["children"] = {0}; }, {"nodes[0]", "tree"}},
      {"node", [](Json& j) { j["scenes"][0]["nodes"] = {3}; }, {"scenes[0].nodes[0]", "3"}},
      {"scene", [](Json& j) { j["scene"] = 3; }, {"scene", "3"}},
      {"matrix", [](Json& j) { j["nodes"][0]["matrix"] = {1, 2, 3}; }, {"nodes[0].matrix", "16"}},
      {"wrong kind", [](Json& j) { j["meshes"] = "none"; }, {"meshes", "array"}},
      {"sparse",
       [](Json& j) {
         j["accessors"][0]["sparse"] = {{"count", 9},
                                        {"indices", {{"bufferView", 0}, {"componentType", 5123}}},
                                        {"values", {{"bufferView", 0}}}};
       },
       {"accessors[0].sparse.count"}},
      {"meshopt",
       [](Json& j) { j["bufferViews"][0]["extensions"]["EXT_meshopt_compression"] = Json::object(); },
       {"bufferViews[0]", "compressed"}},
  };
  for (const BadJson& bad : cases) {
    SCOPED_TRACE(bad.what);
    GltfBuilder b = square();
    bad.spoil(b.json);
    const auto path = folder.file("bird.glb", b.glb());
    expect_error([&] { read_mesh(path); }, ErrorCode::input, bad.words).location();
    expect_error([&] { read_mesh(path); }, ErrorCode::input, {"bird.glb"});
  }
}

TEST(GltfErrors, CopiesAreCountedBeforeTheyAreMade) {
  const TemporaryFolder folder;
  GltfBuilder b;
  const int positions = b.positions(square_positions());
  const std::vector<std::uint16_t> indices(30'000, 1);
  b.show({{"attributes", {{"POSITION", positions}}}, {"indices", b.accessor(indices, "SCALAR")}});
  const Json node = b.json["nodes"][0];
  b.json["scenes"][0]["nodes"] = Json::array();
  for (int n = 0; n < 20'000; ++n) {
    b.json["nodes"][n] = node;
    b.json["scenes"][0]["nodes"].push_back(n);
  }
  const auto path = folder.file("forest.glb", b.glb());
  expect_error([&] { read_mesh(path); }, ErrorCode::input, {"200 million triangles", "nodes"});
}

TEST(GltfErrors, OfContainers) {
  const TemporaryFolder folder;
  const std::string glb = square().glb();
  const auto refuse = [&](const std::string& content, const std::vector<std::string>& words) {
    const auto path = folder.file("a.glb", content);
    expect_error([&] { read_mesh(path); }, ErrorCode::input, words);
  };
  refuse(glb.substr(0, 15), {"byte 15", "header"});
  refuse(glb.substr(0, glb.size() - 4), {"byte 8"});
  refuse(glb + "more", {"byte 8"});
  std::string long_chunk = glb;
  long_chunk[15] = '\x7f';
  refuse(long_chunk, {"byte 12", "chunk"});
  std::string version = glb;
  version[4] = 1;
  refuse(version, {"version 1"});
  std::string no_json = glb;
  no_json[16] = 'X';
  refuse(no_json, {"no JSON"});
  GltfBuilder short_buffer = square();
  short_buffer.buffer.resize(8);
  refuse(short_buffer.glb(), {"bufferViews[0]"});
}

TEST(GltfErrors, OfFilesBesideIt) {
  const TemporaryFolder folder;
  const GltfBuilder b = square();
  const auto read = [&](const std::string& uri) { folder.mesh("a.gltf", b.gltf(uri)); };
  expect_error([&] { read("gone.bin"); }, ErrorCode::io, {"a.gltf", "buffers[0].uri", "gone.bin"});
  expect_error([&] { read("https://example.org/a.bin"); }, ErrorCode::input, {"buffers[0].uri", "no file"});
  expect_error([&] { read("data:application/octet-stream;base64,!!!"); }, ErrorCode::input, {"buffers[0].uri"});
  expect_error([&] { read("data:text/plain,abc"); }, ErrorCode::input, {"base64"});
  folder.file("short.bin", b.buffer.substr(0, 20));
  expect_error([&] { read("short.bin"); }, ErrorCode::input, {"buffers[0]", "20"});
  std::filesystem::create_directory(folder / "sub");
  folder.file("data.bin", b.buffer);
  EXPECT_EQ(folder.mesh("sub/a.gltf", b.gltf("../data.bin")).vertex_count(), 4);
  EXPECT_EQ(folder.mesh("a.gltf", b.gltf((folder / "data.bin").string())).vertex_count(), 4);
}

TEST(GltfErrors, OfJsonText) {
  const TemporaryFolder folder;
  const auto refuse = [&](const std::string& text, const std::vector<std::string>& words) {
    expect_error([&] { folder.mesh("a.gltf", text); }, ErrorCode::input, words);
  };
  refuse("{\n\"asset\": }", {"a.gltf, line 2", "malformed"});
  refuse("[1]", {"no object"});
  refuse("{\"asset\": {\"version\": \"2.0\"}, \"x\": 1e999}", {"too large"});
  refuse(std::string(10000, '['), {"nested"});
  std::string deep = "{\"asset\":{\"version\":\"2.0\"},\"extras\":";
  for (int k = 0; k < 10000; ++k) deep += "{\"a\":";
  refuse(deep, {"nested"});
}

TEST(GltfErrors, IndicesOutOfRangeAndNansAreForCheckMesh) {
  const TemporaryFolder folder;
  GltfBuilder b;
  std::vector<float> p = square_positions();
  p[0] = std::numeric_limits<float>::quiet_NaN();
  const int positions = b.accessor(p, "VEC3");
  b.show({{"attributes", {{"POSITION", positions}}},
          {"indices", b.accessor<std::uint16_t>({0, 1, 2, 0, 2, 9}, "SCALAR")}});
  const Mesh mesh = folder.mesh("a.glb", b.glb());
  EXPECT_EQ(mesh.face_count(), 2);
  EXPECT_GE(mesh.faces.corners()[5], mesh.vertex_count());
  EXPECT_NO_THROW(check_mesh(mesh));
  EXPECT_EQ(folder.written(mesh, "b.glb"), b.glb());
}

TEST(GltfErrors, DamagedFilesAreReadOrRefused) {
  const TemporaryFolder folder;
  GltfBuilder b = square();
  const float value[3] = {2, 2, 1};
  std::string bytes;
  append_bytes(bytes, value, 12);
  const int indices = b.view(std::string("\2\0", 2));
  const int values = b.view(bytes);
  b.json["accessors"][0]["sparse"] = {{"count", 1},
                                      {"indices", {{"bufferView", indices}, {"componentType", 5123}}},
                                      {"values", {{"bufferView", values}}}};
  b.json["meshes"][0]["primitives"][0]["targets"] =
      Json::array({{{"POSITION", b.positions(square_positions())}}});
  const int weights = b.accessor<float>({0, 1}, "SCALAR");
  b.add("animations", {{"channels", {{{"sampler", 0}, {"target", {{"node", 0}, {"path", "weights"}}}}}},
                       {"samplers", {{{"input", weights}, {"output", weights}}}}});
  const std::string whole = b.glb();
  std::mt19937 random(7);
  int read = 0;
  for (int round = 0; round < 600; ++round) {
    std::string damaged = whole;
    if (round % 10 == 0)
      damaged.resize(random() % whole.size());
    else
      for (unsigned k = 0; k <= random() % 3; ++k)
        damaged[random() % damaged.size()] =
            static_cast<char>(random() % 4 == 0 ? random() % 256 : '0' + random() % 10);
    if (damaged.empty()) continue;
    try {
      Mesh mesh = folder.mesh("a.glb", damaged);
      ++read;
      const Points rest = mesh.positions;
      if (round % 3 != 0) continue;  // writing flushes the disk
      if (mesh.vertex_count() > 0) mesh.positions(0, 0) += 1;
      write_mesh(mesh, folder / "b.glb");
      write_mesh(mesh, folder / "c.gltf", {.morph_target = MorphTarget{"m", rest}});
    } catch (const Error& error) {
      EXPECT_NE(error.code(), ErrorCode::internal) << error.what();
    }
  }
  EXPECT_GT(read, 50);
}

}  // namespace
}  // namespace meshgraft::test
