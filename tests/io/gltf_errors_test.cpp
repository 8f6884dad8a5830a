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
  std::string id;
  std::function<void(Json&)> spoil;
  std::vector<std::string> words;
};

TEST(GltfErrors, NameThePlaceInTheJson) {
  const TemporaryFolder folder;
  const std::vector<BadJson> cases = {
      {"version",
       "gltf.unknown_version",
       [](Json& j) { j["asset"]["version"] = "1.0"; },
       {"asset.version", "1.0"}},
      {"no version", "gltf.member_missing", [](Json& j) { j.erase("asset"); }, {"asset", "missing"}},
      {"draco",
       "gltf.extension_not_read",
       [](Json& j) { j["extensionsRequired"] = {"KHR_draco_mesh_compression"}; },
       {"extensionsRequired[0]", "draco"}},
      {"view range",
       "gltf.beyond_bytes",
       [](Json& j) { j["bufferViews"][0]["byteLength"] = 1e9; },
       {"bufferViews[0]", "beyond"}},
      {"view overflow",
       "gltf.beyond_bytes",
       [](Json& j) { j["bufferViews"][0]["byteOffset"] = 9007199254740992ULL; },
       {"bufferViews[0]", "beyond"}},
      {"accessor overflow",
       "gltf.beyond_bytes",
       [](Json& j) { j["accessors"][0]["byteOffset"] = 9007199254740992ULL; },
       {"accessors[0]", "beyond"}},
      {"count",
       "gltf.beyond_bytes",
       [](Json& j) { j["accessors"][0]["count"] = 5; },
       {"accessors[0]", "beyond"}},
      {"huge count",
       "gltf.beyond_bytes",
       [](Json& j) { j["accessors"][0]["count"] = 2000000000; },
       {"accessors[0]", "beyond"}},
      {"too huge count",
       "io.too_many",
       [](Json& j) { j["accessors"][0]["count"] = 1e15; },
       {"accessors[0].count", "2147483647"}},
      {"zeros",
       "gltf.count_without_data",
       [](Json& j) {
         j["accessors"][0].erase("bufferView");
         j["accessors"][0]["count"] = 2000000000;
       },
       {"accessors[0]", "no bufferView"}},
      {"reference",
       "gltf.index_out_of_range",
       [](Json& j) { j["accessors"][0]["bufferView"] = 7; },
       {"accessors[0].bufferView", "7", "2 bufferViews"}},
      {"negative",
       "gltf.wrong_type",
       [](Json& j) { j["accessors"][0]["bufferView"] = -1; },
       {"accessors[0].bufferView"}},
      {"type",
       "gltf.unknown_constant",
       [](Json& j) { j["accessors"][0]["componentType"] = 5124; },
       {"accessors[0].componentType"}},
      {"shape",
       "gltf.wrong_size",
       [](Json& j) { j["accessors"][0]["type"] = "VEC2"; },
       {"POSITION", "components"}},
      {"stride",
       "gltf.stride_mismatch",
       [](Json& j) { j["bufferViews"][0]["byteStride"] = 4; },
       {"bufferViews[0]", "byteStride"}},
      {"cycle",
       "gltf.node_reached_twice",
       [](Json& j) { j["nodes"][0]["children"] = {0}; },
       {"nodes[0]", "tree"}},
      {"node",
       "gltf.index_out_of_range",
       [](Json& j) { j["scenes"][0]["nodes"] = {3}; },
       {"scenes[0].nodes[0]", "3"}},
      {"scene", "gltf.index_out_of_range", [](Json& j) { j["scene"] = 3; }, {"scene", "3"}},
      {"matrix",
       "gltf.wrong_size",
       [](Json& j) { j["nodes"][0]["matrix"] = {1, 2, 3}; },
       {"nodes[0].matrix", "16"}},
      {"wrong kind", "gltf.wrong_type", [](Json& j) { j["meshes"] = "none"; }, {"meshes", "array"}},
      {"sparse",
       "gltf.sparse_count_too_large",
       [](Json& j) {
         j["accessors"][0]["sparse"] = {{"count", 9},
                                        {"indices", {{"bufferView", 0}, {"componentType", 5123}}},
                                        {"values", {{"bufferView", 0}}}};
       },
       {"accessors[0].sparse.count"}},
      {"meshopt",
       "gltf.compressed",
       [](Json& j) { j["bufferViews"][0]["extensions"]["EXT_meshopt_compression"] = Json::object(); },
       {"bufferViews[0]", "compressed"}},
  };
  for (const BadJson& bad : cases) {
    SCOPED_TRACE(bad.what);
    GltfBuilder b = square();
    bad.spoil(b.json);
    const auto path = folder.file("bird.glb", b.glb());
    const Error error = expect_error([&] { read_mesh(path); }, bad.id, bad.words);
    EXPECT_EQ(error.code(), ErrorCode::input);
    EXPECT_NE(error.location().text().find("bird.glb"), std::string::npos) << error.location().text();
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
  const Error error = expect_error([&] { read_mesh(path); }, "gltf.too_many_triangles", {"nodes"});
  EXPECT_EQ(error.fact().get<std::int64_t>("millions"), 200);
}

TEST(GltfErrors, OfContainers) {
  const TemporaryFolder folder;
  const std::string glb = square().glb();
  const auto refuse = [&](const std::string& content, const std::string& id, const std::string& words) {
    const auto path = folder.file("a.glb", content);
    expect_error([&] { read_mesh(path); }, id, {words});
  };
  refuse(glb.substr(0, 15), "io.truncated_header", "byte 15");
  refuse(glb.substr(0, glb.size() - 4), "gltf.wrong_length", "byte 8");
  refuse(glb + "more", "gltf.wrong_length", "byte 8");
  std::string long_chunk = glb;
  long_chunk[15] = '\x7f';
  refuse(long_chunk, "gltf.wrong_length", "byte 12: the chunk");
  std::string version = glb;
  version[4] = 1;
  refuse(version, "gltf.unknown_version", "version 1");
  std::string no_json = glb;
  no_json[16] = 'X';
  refuse(no_json, "gltf.first_chunk_not_json", "byte 16");
  GltfBuilder short_buffer = square();
  short_buffer.buffer.resize(8);
  refuse(short_buffer.glb(), "gltf.beyond_bytes", "bufferViews[0]");
}

TEST(GltfErrors, OfFilesBesideIt) {
  const TemporaryFolder folder;
  const GltfBuilder b = square();
  const auto read = [&](const std::string& uri) { folder.mesh("a.gltf", b.gltf(uri)); };
  expect_error([&] { read("gone.bin"); }, ErrorCode::io, {"a.gltf", "buffers[0].uri", "gone.bin"});
  const auto refuse = [&](const std::string& uri, const std::string& id, const std::string& words) {
    expect_error([&] { read(uri); }, id, {words});
  };
  refuse("https://example.org/a.bin", "gltf.uri_not_local", "buffers[0].uri");
  refuse("", "gltf.uri_not_local", "buffers[0].uri");
  refuse("data:application/octet-stream;base64,!!!", "gltf.data_uri_not_base64", "buffers[0].uri");
  refuse("data:text/plain,abc", "gltf.data_uri_not_base64", "buffers[0].uri");
  folder.file("short.bin", b.buffer.substr(0, 20));
  refuse("short.bin", "gltf.wrong_length", "buffers[0]: the buffer");
  std::filesystem::create_directory(folder / "sub");
  refuse("sub", "io.is_folder", "buffers[0].uri");
  folder.file("data.bin", b.buffer);
  EXPECT_EQ(folder.mesh("sub/a.gltf", b.gltf("../data.bin")).vertex_count(), 4);
  EXPECT_EQ(folder.mesh("a.gltf", b.gltf((folder / "data.bin").string())).vertex_count(), 4);
}

TEST(GltfErrors, AFileThatManyBuffersNameIsReadOnce) {
  const TemporaryFolder folder;
  GltfBuilder b = square();
  b.buffer.resize(std::size_t{1} << 20, '\0');
  folder.file("data.bin", b.buffer);
  Json json = Json::parse(b.gltf("data.bin"));
  for (int k = 1; k < 60; ++k) json["buffers"].push_back({{"byteLength", 4}, {"uri", "./data.bin"}});
  const auto path = folder.file("a.gltf", json.dump());
  Context context;
  context.memory = std::uint64_t{3} << 20;
  EXPECT_EQ(read_mesh(path, context).vertex_count(), 4);
  for (int k = 1; k < 4; ++k) {
    const std::string name = "more" + std::to_string(k) + ".bin";
    folder.file(name.c_str(), b.buffer);
    json["buffers"][static_cast<std::size_t>(k)]["uri"] = name;
  }
  folder.file("a.gltf", json.dump());
  expect_error([&] { read_mesh(path, context); }, "core.over_budget",
               {"a.gltf", "buffers[", "3 MB are allowed"});
}

TEST(GltfErrors, OfJsonText) {
  const TemporaryFolder folder;
  const auto refuse = [&](const std::string& text, const std::string& id, const std::string& words) {
    expect_error([&] { folder.mesh("a.gltf", text); }, id, {words});
  };
  refuse("{\n\"asset\": }", "gltf.json_malformed", "a.gltf, line 2");
  refuse("[1]", "gltf.json_not_an_object", "begins with '{'");
  refuse("{\"asset\": {\"version\": \"2.0\"}, \"x\": 1e999}", "gltf.json_number_too_large", "a.gltf");
  refuse(std::string(10000, '['), "gltf.json_too_deep", "200 deep");
  std::string deep = "{\"asset\":{\"version\":\"2.0\"},\"extras\":";
  for (int k = 0; k < 10000; ++k) deep += "{\"a\":";
  refuse(deep, "gltf.json_too_deep", "200 deep");
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
      if (round % 3 != 0) continue;  // writing is slow, because it flushes the disk
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
