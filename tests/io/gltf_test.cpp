#include <cmath>
#include <cstring>
#include <functional>
#include <set>
#include <string>
#include <vector>

#include <gtest/gtest.h>
#include <Eigen/Geometry>

#include <meshgraft/core/error.h>
#include <meshgraft/io/mesh_io.h>
#include <meshgraft/mesh/normals.h>

#include "expect_error.h"
#include "gltf_builder.h"
#include "temporary_folder.h"

namespace meshgraft::test {
namespace {

struct Case {
  std::string name;
  GltfBuilder builder;
  Index vertices = 0;
  Index faces = 0;
};

// A square with everything that a vertex can have.
GltfBuilder rich_square() {
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

GltfBuilder plain_square() {
  GltfBuilder b;
  const int positions = b.positions(square_positions());
  b.show({{"attributes", {{"POSITION", positions}}}, {"indices", b.accessor(square_indices(), "SCALAR")}});
  return b;
}

GltfBuilder hierarchy() {
  GltfBuilder b = rich_square();
  b.json["nodes"] = Json::array(
      {{{"name", "root"}, {"translation", {1, 2, 3}}, {"children", {1, 2}}},
       {{"rotation", {0, 0, 0.6, 0.8}}, {"scale", {2, 0.5, 1}}, {"children", {3}}},
       {{"name", "camera holder"}, {"extras", "x"}},
       {{"name", "mirror"}, {"matrix", {-1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 5, 0, 0, 1}}, {"mesh", 0}}});
  return b;
}

// Two triangles that share no index, one per primitive, with a seam in the UVs where they meet.
GltfBuilder soup_with_seam() {
  GltfBuilder b;
  const int p = b.positions({0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 0, 0, 1, 1, 0, 0, 1, 0});
  const int uv = b.accessor<float>({0, 0, 1, 0, 1, 1, 0.5, 0.5, 0.25, 0.25, 0, 1}, "VEC2");
  b.show({{"attributes", {{"POSITION", p}, {"TEXCOORD_0", uv}}}});
  return b;
}

GltfBuilder two_primitives() {
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

GltfBuilder interleaved() {
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

GltfBuilder sparse() {
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

GltfBuilder skinned() {
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

GltfBuilder morphed_and_animated() {
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

GltfBuilder quantised() {
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

GltfBuilder stripped(int mode) {
  GltfBuilder b;
  const int p =
      b.positions(mode == 5 ? std::vector<float>{0, 0, 0, 1, 0, 0, 0, 1, 0, 1, 1, 0} : square_positions());
  b.show({{"attributes", {{"POSITION", p}}}, {"mode", mode}});
  return b;
}

std::vector<Case> cases() {
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

void move(Mesh& mesh, double amount = 0.1) {
  const Points rest = mesh.positions;
  for (Index v = 0; v < mesh.vertex_count(); ++v)
    mesh.positions.row(v) += amount * Eigen::RowVector3d(std::sin(v), std::cos(v), 0.5 * v);
  update_normals(mesh, rest);
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

TEST(Gltf, ReadsWhatThereIs) {
  const TemporaryFolder folder;
  for (const Case& c : cases()) {
    const Mesh mesh = folder.mesh("a.glb", c.builder.glb());
    EXPECT_EQ(mesh.vertex_count(), c.vertices) << c.name;
    EXPECT_EQ(mesh.face_count(), c.faces) << c.name;
    for (const double corner : mesh.faces.corners()) EXPECT_LT(corner, c.vertices) << c.name;
  }
}

TEST(Gltf, WithoutAnEditComesBackByteForByte) {
  const TemporaryFolder folder;
  for (const Case& c : cases()) {
    for (const int indent : {-1, 3}) {
      const std::string glb = c.builder.glb(indent);
      EXPECT_EQ(folder.written(folder.mesh("a.glb", glb), "b.glb"), glb) << c.name;
    }
    folder.file("a b.bin", c.builder.buffer);
    const std::string gltf = c.builder.gltf("a%20b.bin");
    EXPECT_EQ(folder.written(folder.mesh("a.gltf", gltf), "b.gltf"), gltf) << c.name;
  }
}

TEST(Gltf, AnEditOfPositionsLeavesEverythingElse) {
  const TemporaryFolder folder;
  for (const Case& c : cases()) {
    const std::string before = c.builder.glb(2);
    Mesh mesh = folder.mesh("a.glb", before);
    move(mesh);
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
  for (const Case& c : cases()) {
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

TEST(Gltf, ASkinsNodeHasNoSay) {
  const TemporaryFolder folder;
  EXPECT_LE(folder.mesh("a.glb", skinned().glb()).positions.maxCoeff(), 1);
}

// --- instances ---

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

// --- containers ---

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
  move(mesh);
  const Json after = Json::parse(folder.written(mesh, "b.gltf"));
  EXPECT_TRUE(after["buffers"][0]["uri"].get<std::string>().starts_with(head));
  EXPECT_LT((read_mesh(folder / "b.gltf").positions - mesh.positions).norm(), 1e-6);
  EXPECT_EQ(folder.entry_count(), 2U);
}

TEST(Gltf, NeverReplacesTheBufferOfItsInput) {
  const TemporaryFolder folder;
  const GltfBuilder b = plain_square();
  folder.file("out.bin", b.buffer);  // the input's buffer has the name that the output's would get
  Mesh mesh = folder.mesh("in.gltf", b.gltf("out.bin"));
  move(mesh);
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
  move(mesh);
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
  move(mesh);
  EXPECT_TRUE(folder.written(mesh, "b.glb").ends_with("ODD.data"));
  EXPECT_EQ(read_mesh(folder / "b.glb").vertex_count(), 4);
}

}  // namespace
}  // namespace meshgraft::test
