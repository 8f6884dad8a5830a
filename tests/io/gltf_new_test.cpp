#include <cmath>
#include <string>
#include <vector>

#include <gtest/gtest.h>
#include <Eigen/Geometry>

#include <meshgraft/core/error.h>
#include <meshgraft/io/mesh_io.h>
#include <meshgraft/mesh/normals.h>
#include <meshgraft/samples/samples.h>

#include "expect_error.h"
#include "gltf_builder.h"
#include "io/file.h"
#include "temporary_folder.h"

namespace meshgraft::test {
namespace {

// Two squares side by side, of two objects and two materials, with a seam in the UVs between them.
constexpr const char* two_squares =
    "o left\nusemtl red\n"
    "v 0 0 0\nv 1 0 0\nv 2 0 0\nv 0 1 0\nv 1 1 0\nv 2 1 0\n"
    "vt 0 0\nvt 1 0\nvt 1 1\nvt 0 1\nvn 0 0 1\n"
    "f 1/1/1 2/2/1 5/3/1 4/4/1\n"
    "o right\nusemtl blue\n"
    "f 2/1/1 3/2/1 6/3/1 5/4/1\n";

TEST(GltfNew, HasANodePerObjectAndAPrimitivePerMaterial) {
  const TemporaryFolder folder;
  const Mesh mesh = folder.mesh("a.obj", two_squares);
  const WriteResult result = write_mesh(mesh, folder / "a.glb");
  ASSERT_FALSE(result.notes.empty());
  EXPECT_EQ(result.notes[0].id(), "io.polygons_split");
  EXPECT_EQ(result.notes[0].get<std::int64_t>("count"), 2);
  const Json json = parts_of(read_file(folder / "a.glb")).json;
  ASSERT_EQ(json["nodes"].size(), 2U);
  EXPECT_EQ(json["nodes"][0]["name"], "left");
  EXPECT_EQ(json["materials"][1]["name"], "blue");
  EXPECT_EQ(json["meshes"][1]["primitives"][0]["material"], 1);
  EXPECT_EQ(json["scenes"][0]["nodes"], Json({0, 1}));
  const Mesh again = read_mesh(folder / "a.glb");
  EXPECT_EQ(again.vertex_count(), 8);
  EXPECT_EQ(again.face_count(), 4);
  EXPECT_EQ(again.find_attribute(Domain::vertex, "uv")->values,
            (std::vector<double>{0, 0, 1, 0, 1, 1, 0, 1, 0, 0, 1, 0, 1, 1, 0, 1}));
  EXPECT_EQ(again.find_attribute(Domain::face, "material")->labels, (std::vector<std::string>{"red", "blue"}));
}

TEST(GltfNew, SplitsVerticesWhereCornersDiffer) {
  const TemporaryFolder folder;
  Mesh mesh = folder.mesh("a.obj", two_squares);
  std::erase_if(mesh.attributes, [](const Attribute& a) { return a.domain == Domain::face; });
  write_mesh(mesh, folder / "a.gltf");
  const Json json = Json::parse(read_file(folder / "a.gltf"));
  const std::size_t positions = json["meshes"][0]["primitives"][0]["attributes"]["POSITION"];
  EXPECT_EQ(json["accessors"][positions]["count"], 8);
  EXPECT_EQ(json["buffers"][0]["uri"], "a.bin");
  const Mesh again = read_mesh(folder / "a.gltf");
  EXPECT_EQ(again.vertex_count(), 6) << "one vertex again where the places are one";
  EXPECT_NE(again.find_attribute(Domain::corner, "uv"), nullptr);
}

TEST(GltfNew, OfSamplesIsTheSameMesh) {
  const TemporaryFolder folder;
  for (const char* name : {"octopus", "head"}) {
    const Mesh mesh = make_sample(name, 20);
    write_mesh(mesh, folder / "a.glb");
    const Mesh again = read_mesh(folder / "a.glb");
    EXPECT_EQ(again.face_count(), triangulate(mesh).triangles.rows());
    EXPECT_EQ(again.vertex_count(), mesh.vertex_count());
    const Eigen::RowVector3d box = mesh.positions.colwise().maxCoeff();
    EXPECT_LT((again.positions.colwise().maxCoeff() - box).norm(), 1e-6);
  }
}

TEST(GltfNew, TellsOfCoordinatesThatFloatsCannotHold) {
  const TemporaryFolder folder;
  Mesh mesh = folder.mesh("a.obj", two_squares);
  mesh.positions.col(0).array() += 1e6 + 0.01;
  EXPECT_EQ(write_mesh(mesh, folder / "a.glb").notes.at(1).id(), "io.coordinates_coarse");
  mesh.positions(0, 0) = 1e60;
  expect_error([&] { write_mesh(mesh, folder / "a.glb"); }, "gltf.coordinate_beyond_floats", {"vertex 0"});
}

TEST(GltfNew, NeverReplacesSomebodysBuffer) {
  const TemporaryFolder folder;
  folder.file("a.bin", "precious");
  write_mesh(folder.mesh("a.obj", two_squares), folder / "a.gltf");
  EXPECT_EQ(read_file(folder / "a.bin"), "precious");
  EXPECT_EQ(read_mesh(folder / "a.gltf").face_count(), 4);
}

// --- morph targets ---

Mesh bent(Mesh mesh) {
  const Points rest = mesh.positions;
  for (Index v = 0; v < mesh.vertex_count(); ++v) mesh.positions(v, 2) += 0.25 * mesh.positions(v, 0);
  mesh.positions.row(0) = rest.row(0);
  update_normals(mesh, rest);
  return mesh;
}

TEST(GltfMorphTarget, OfAnotherSourceIsTheEdit) {
  const TemporaryFolder folder;
  const Mesh rest = folder.mesh("a.obj", two_squares);
  const Mesh edited = bent(rest);
  write_mesh(edited, folder / "a.glb", {.morph_target = MorphTarget{"bend", rest.positions}});
  const GlbParts parts = parts_of(read_file(folder / "a.glb"));
  for (const Json& mesh : parts.json["meshes"]) {
    EXPECT_EQ(mesh["weights"], Json({0.0}));
    EXPECT_EQ(mesh["extras"]["targetNames"], Json({"bend"}));
    const Json& primitive = mesh["primitives"][0];
    ASSERT_EQ(primitive["targets"].size(), 1U);
    const auto base = accessor_floats(parts, primitive["attributes"]["POSITION"]);
    const auto delta = accessor_floats(parts, primitive["targets"][0]["POSITION"]);
    ASSERT_EQ(base.size(), delta.size());
    for (std::size_t i = 0; i < base.size(); i += 3) {
      EXPECT_FLOAT_EQ(delta[i + 2], 0.25F * base[i]);
      EXPECT_EQ(base[i + 2], 0);
    }
    EXPECT_TRUE(primitive["targets"][0].contains("NORMAL"));
  }
}

GltfBuilder morphed_pair() {
  GltfBuilder b;
  const Json attributes = {{"POSITION", b.positions(square_positions())},
                           {"NORMAL", b.accessor<float>({0, 0, 1, 0, 0, 1, 0, 0, 1, 0, 0, 1}, "VEC3")}};
  const int lift = b.positions({0, 0, 1, 0, 0, 0, 0, 0, 0, 0, 0, 0});
  b.show({{"attributes", attributes},
          {"indices", b.accessor(square_indices(), "SCALAR")},
          {"targets", {{{"POSITION", lift}}}}});
  b.json["meshes"][0]["primitives"].push_back(
      {{"attributes", {{"POSITION", b.positions({5, 0, 0, 6, 0, 0, 5, 1, 0})}}},
       {"targets", {{{"POSITION", b.positions(std::vector<float>(9, 0))}}}}});
  b.json["meshes"][0]["weights"] = {0.5};
  b.json["meshes"][0]["extras"] = {{"targetNames", {"lift"}}, {"more", true}};
  b.json["nodes"][0]["weights"] = {0.75};
  const int times = b.accessor<float>({0, 1, 2}, "SCALAR");
  const int values = b.accessor<float>({0.1F, 0.2F, 0.3F}, "SCALAR");
  b.add("animations", {{"channels", {{{"sampler", 0}, {"target", {{"node", 0}, {"path", "weights"}}}}}},
                       {"samplers", {{{"input", times}, {"output", values}}}}});
  return b;
}

TEST(GltfMorphTarget, OfAGltfFileJoinsThoseThatAreThere) {
  const TemporaryFolder folder;
  const std::string before = morphed_pair().glb(2);
  const GlbParts old_parts = parts_of(before);
  const Mesh rest = folder.mesh("a.glb", before);
  Mesh edited = rest;
  edited.positions(1, 2) += 0.5;
  edited.positions(2, 2) += 0.25;
  update_normals(edited, rest.positions);
  write_mesh(edited, folder / "b.glb", {.morph_target = MorphTarget{"edit", rest.positions}});
  const GlbParts parts = parts_of(read_file(folder / "b.glb"));
  EXPECT_EQ(parts.binary.substr(0, old_parts.binary.size()), old_parts.binary);
  EXPECT_EQ(read_mesh(folder / "b.glb").positions, rest.positions);
  const Json& mesh = parts.json["meshes"][0];
  EXPECT_EQ(mesh["weights"], Json({0.5, 0.0}));
  EXPECT_EQ(mesh["extras"], Json({{"targetNames", {"lift", "edit"}}, {"more", true}}));
  EXPECT_EQ(parts.json["nodes"][0]["weights"], Json({0.75, 0.0}));
  for (const Json& primitive : mesh["primitives"]) ASSERT_EQ(primitive["targets"].size(), 2U);
  const Json& target = mesh["primitives"][0]["targets"][1];
  EXPECT_FALSE(target.contains("NORMAL")) << "as the target before it";
  EXPECT_EQ(accessor_floats(parts, target["POSITION"]),
            (std::vector<float>{0, 0, 0, 0, 0, 0.5F, 0, 0, 0.25F, 0, 0, 0}));
  // The mesh now has two targets, so animated weights come in pairs.
  const Json& animation = parts.json["animations"][0];
  const Json& sampler = animation["samplers"][animation["channels"][0]["sampler"].get<std::size_t>()];
  EXPECT_EQ(accessor_floats(parts, sampler["output"]), (std::vector<float>{0.1F, 0, 0.2F, 0, 0.3F, 0}));
}

TEST(GltfMorphTarget, OnlyTheEditedInstanceGetsIt) {
  const TemporaryFolder folder;
  GltfBuilder b = morphed_pair();
  b.add("nodes", {{"mesh", 0}, {"translation", {0, 9, 0}}});
  b.json["scenes"][0]["nodes"].push_back(1);
  const Mesh rest = folder.mesh("a.glb", b.glb());
  Mesh edited = rest;
  edited.positions(rest.vertex_count() - 1, 2) += 1;
  write_mesh(edited, folder / "b.glb", {.morph_target = MorphTarget{"edit", rest.positions}});
  const Json json = parts_of(read_file(folder / "b.glb")).json;
  EXPECT_EQ(json["meshes"][0]["weights"].size(), 1U);
  EXPECT_EQ(json["meshes"][1]["weights"].size(), 2U);
  EXPECT_EQ(json["nodes"][1]["mesh"], 1);
}

TEST(GltfMorphTarget, NeedsAFormatAndTheVertices) {
  const TemporaryFolder folder;
  const Mesh mesh = folder.mesh("a.obj", two_squares);
  const WriteOptions good{.morph_target = MorphTarget{"x", mesh.positions}};
  expect_error([&] { write_mesh(mesh, folder / "b.ply", good); }, ErrorCode::usage, {"b.ply", ".glb"});
  const WriteOptions bad{.morph_target = MorphTarget{"x", mesh.positions.topRows(3)}};
  expect_error([&] { write_mesh(mesh, folder / "b.glb", bad); }, ErrorCode::usage, {"3 rows"});
}

}  // namespace
}  // namespace meshgraft::test
