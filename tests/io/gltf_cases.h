#pragma once

#include <cmath>
#include <cstdint>
#include <string>
#include <vector>

#include <meshgraft/mesh/normals.h>

#include "gltf_builder.h"

/// glTF files for tests, each with another feature of the format.
namespace meshgraft::test {

struct GltfCase {
  std::string name;
  GltfBuilder builder;
  Index vertices = 0;
  Index faces = 0;
};

/// A square with everything that a vertex can have.
inline GltfBuilder rich_square() {
  GltfBuilder b;
  Json attributes = {{"POSITION", b.positions(square_positions())}};
  attributes["NORMAL"] = b.accessor<float>({0, 0, 1, 0, 0, 1, 0, 0, 1, 0, 0, 1}, "VEC3");
  attributes["TANGENT"] = b.accessor<float>({1, 0, 0, 1, 1, 0, 0, 1, 1, 0, 0, 1, 1, 0, 0, 1}, "VEC4");
  attributes["TEXCOORD_0"] = b.accessor<float>({0, 1, 1, 1, 1, 0, 0, 0}, "VEC2");
  attributes["TEXCOORD_1"] = b.accessor<std::uint16_t>({0, 0, 65535, 0, 65535, 65535, 0, 65535}, "VEC2");
  b.json["accessors"][4]["normalized"] = true;
  attributes["COLOR_0"] =
      b.accessor<std::uint8_t>({255, 0, 0, 255, 0, 255, 0, 255, 0, 0, 255, 255, 51, 51, 51, 0}, "VEC4");
  b.json["accessors"][5]["normalized"] = true;
  const int indices = b.accessor(square_indices(), "SCALAR");
  b.add("materials", {{"name", "paint"}, {"pbrMetallicRoughness", {{"metallicFactor", 0.10}}}});
  b.show({{"attributes", attributes}, {"indices", indices}, {"material", 0}});
  b.json["nodes"][0]["name"] = "panel";
  b.json["extras"] = {{"made by", "nobody"}, {"n", 1e-3}};
  return b;
}

inline GltfBuilder plain_square() {
  GltfBuilder b;
  const int positions = b.positions(square_positions());
  b.show({{"attributes", {{"POSITION", positions}}}, {"indices", b.accessor(square_indices(), "SCALAR")}});
  return b;
}

inline GltfBuilder hierarchy() {
  GltfBuilder b = rich_square();
  b.json["nodes"] = Json::array(
      {{{"name", "root"}, {"translation", {1, 2, 3}}, {"children", {1, 2}}},
       {{"rotation", {0, 0, 0.6, 0.8}}, {"scale", {2, 0.5, 1}}, {"children", {3}}},
       {{"name", "camera holder"}, {"extras", "x"}},
       {{"name", "mirror"}, {"matrix", {-1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 5, 0, 0, 1}}, {"mesh", 0}}});
  return b;
}

/// Two triangles that share no index, one per primitive, with a seam in the UVs where they meet.
inline GltfBuilder soup_with_seam() {
  GltfBuilder b;
  const int p = b.positions({0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 0, 0, 1, 1, 0, 0, 1, 0});
  const int uv = b.accessor<float>({0, 0, 1, 0, 1, 1, 0.5, 0.5, 0.25, 0.25, 0, 1}, "VEC2");
  b.show({{"attributes", {{"POSITION", p}, {"TEXCOORD_0", uv}}}});
  return b;
}

inline GltfBuilder two_primitives() {
  GltfBuilder b;
  const int p = b.positions(square_positions());
  const Json attributes = {{"POSITION", p}};
  b.add("materials", Json::object());
  b.add("materials", {{"name", "skin"}, {"extensions", {{"EXT_nobody_knows", {{"a", 1}}}}}});
  b.show({{"attributes", attributes},
          {"indices", b.accessor<std::uint8_t>({0, 1, 2}, "SCALAR")},
          {"material", 0}});
  b.json["meshes"][0]["primitives"].push_back({{"attributes", attributes},
                                               {"indices", b.accessor<std::uint32_t>({0, 2, 3}, "SCALAR")},
                                               {"material", 1}});
  b.json["meshes"][0]["primitives"].push_back(
      {{"attributes", attributes}, {"indices", b.accessor<std::uint32_t>({0, 2}, "SCALAR")}, {"mode", 1}});
  return b;
}

inline GltfBuilder interleaved() {
  GltfBuilder b;
  std::string bytes;
  const std::vector<float> p = square_positions();
  for (std::size_t v = 0; v < 4; ++v) {
    const float normal[3] = {0, 0, 1};
    append_bytes(bytes, &p[3 * v], 12);
    append_bytes(bytes, normal, 12);
    const std::uint8_t junk[4] = {1, 2, 3, static_cast<std::uint8_t>(v)};
    append_bytes(bytes, junk, 4);
  }
  const int view = b.view(bytes, 28);
  const int positions = b.accessor(view, 5126, 4, "VEC3");
  const int normals = b.accessor(view, 5126, 4, "VEC3", 12);
  b.json["accessors"][0]["min"] = {0.0, 0.0, 0.0};
  b.json["accessors"][0]["max"] = {1.0, 1.0, 0.0};
  b.show({{"attributes", {{"NORMAL", normals}, {"POSITION", positions}}},
          {"indices", b.accessor(square_indices(), "SCALAR")}});
  return b;
}

inline GltfBuilder sparse() {
  GltfBuilder b = plain_square();
  std::string index("\2\0", 2);
  const float value[3] = {2, 2, 1};
  std::string bytes;
  append_bytes(bytes, value, 12);
  const int indices = b.view(index);
  const int values = b.view(bytes);
  b.json["accessors"][0]["sparse"] = {{"count", 1},
                                      {"indices", {{"bufferView", indices}, {"componentType", 5123}}},
                                      {"values", {{"bufferView", values}}}};
  b.json["accessors"][0]["max"] = {2.0, 2.0, 1.0};
  return b;
}

inline GltfBuilder skinned() {
  GltfBuilder b = rich_square();
  Json& attributes = b.json["meshes"][0]["primitives"][0]["attributes"];
  attributes["JOINTS_0"] = b.accessor<std::uint8_t>(std::vector<std::uint8_t>(16, 0), "VEC4");
  attributes["WEIGHTS_0"] = b.accessor<float>({1, 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0}, "VEC4");
  const int ibm = b.accessor<float>({1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1}, "MAT4");
  b.add("nodes", {{"name", "bone"}});
  b.json["nodes"][0]["skin"] = 0;
  b.json["nodes"][0]["translation"] = {100, 0, 0};
  b.json["scenes"][0]["nodes"].push_back(1);
  b.add("skins", {{"joints", {1}}, {"inverseBindMatrices", ibm}});
  return b;
}

inline GltfBuilder morphed_and_animated() {
  GltfBuilder b = rich_square();
  Json& mesh = b.json["meshes"][0];
  mesh["primitives"][0]["targets"] =
      Json::array({{{"POSITION", b.positions({0, 0, 1, 0, 0, 0, 0, 0, 0, 0, 0, 0})}}});
  mesh["weights"] = {0.25};
  mesh["extras"] = {{"targetNames", {"lift"}}};
  const int times = b.accessor<float>({0, 1}, "SCALAR");
  const int weights = b.accessor<float>({0, 1}, "SCALAR");
  b.add("animations", {{"channels", {{{"sampler", 0}, {"target", {{"node", 0}, {"path", "weights"}}}}}},
                       {"samplers", {{{"input", times}, {"output", weights}}}}});
  return b;
}

inline GltfBuilder quantised() {
  GltfBuilder b;
  // Each position is padded to a multiple of 4 bytes, as vertex attributes have to be.
  std::vector<std::int16_t> padded = {-16384, -16384, 0, 0, 16384,  -16384, 0, 0,
                                      16384,  16384,  0, 0, -16384, 16384,  0, 0};
  std::string bytes;
  append_bytes(bytes, padded.data(), padded.size() * 2);
  const int p = b.accessor(b.view(bytes, 8), 5122, 4, "VEC3");
  b.json["accessors"][0]["normalized"] = true;
  b.json["accessors"][0]["min"] = {-16384, -16384, 0};
  b.json["accessors"][0]["max"] = {16384, 16384, 0};
  b.json["extensionsRequired"] = {"KHR_mesh_quantization"};
  b.json["extensionsUsed"] = {"KHR_mesh_quantization"};
  b.show({{"attributes", {{"POSITION", p}}}, {"indices", b.accessor(square_indices(), "SCALAR")}});
  return b;
}

inline GltfBuilder stripped(int mode) {
  GltfBuilder b;
  const int p =
      b.positions(mode == 5 ? std::vector<float>{0, 0, 0, 1, 0, 0, 0, 1, 0, 1, 1, 0} : square_positions());
  b.show({{"attributes", {{"POSITION", p}}}, {"mode", mode}});
  return b;
}

inline std::vector<GltfCase> gltf_cases() {
  return {{"plain", plain_square(), 4, 2},
          {"rich", rich_square(), 4, 2},
          {"hierarchy", hierarchy(), 4, 2},
          {"seam", soup_with_seam(), 4, 2},
          {"primitives", two_primitives(), 4, 2},
          {"interleaved", interleaved(), 4, 2},
          {"sparse", sparse(), 4, 2},
          {"skinned", skinned(), 4, 2},
          {"morphed", morphed_and_animated(), 4, 2},
          {"quantised", quantised(), 4, 2},
          {"strip", stripped(5), 4, 2},
          {"fan", stripped(6), 4, 2}};
}

inline void move_vertices(Mesh& mesh, double amount = 0.1) {
  const Points rest = mesh.positions;
  for (Index v = 0; v < mesh.vertex_count(); ++v)
    mesh.positions.row(v) += amount * Eigen::RowVector3d(std::sin(v), std::cos(v), 0.5 * v);
  update_normals(mesh, rest);
}

}  // namespace meshgraft::test
