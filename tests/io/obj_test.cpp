#include <array>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <string>
#include <vector>

#include <gtest/gtest.h>
#include <tiny_obj_loader.h>

#include <meshgraft/core/error.h>
#include <meshgraft/mesh/join.h>
#include <meshgraft/mesh/refine.h>

#include "damage.h"
#include "expect_error.h"
#include "temporary_folder.h"

namespace meshgraft {
namespace {

using test::expect_error;
using test::TemporaryFolder;
using test::with_line_ends;

/// A cube's corner with everything: seams, shared normals, groups, relative indices, lines of other kinds.
const std::string rich =
    "# made by hand, saved as C:\\\n"
    "mtllib skin and bones.mtl\n"
    "o  Figure one \n"
    "v 0 0 0 0.5 0.25 1\n"
    "v 1.000 0 0 1 1 1\n"
    "v 1 1. +0 0 0 0\n"
    "v 0 1e0 -0\t.1 .2 .3   # a corner\n"
    "v 0.5 0.5 1 0 0 1\n"
    "vt 0 0\n"
    "vt 1 0 0\n"
    "vt 1 1\n"
    "vt 0.75 0.75\n"
    "vn 0 0 1\n"
    "vn 0 -1 0\n"
    "vp 0.1 0.2\n"
    "g lower half\n"
    "usemtl skin\n"
    "s 1\n"
    "f 1/1/1 2/2/1 3/3/1 4//1\n"
    "g upper\n"
    "s off\n"
    "usemtl bones\n"
    "f -5/4/-1 \\\n"
    "  2/2/2 5//2\n"
    "f 2 3 5\n"
    "l 1 2 3\n"
    "p 1\n"
    "curv 0 1 1 2\n"
    "unheard-of 1 2 3\n";

void expect_labels(const Mesh& mesh, const char* name, const std::vector<double>& values,
                   const std::vector<std::string>& labels) {
  const Attribute* attribute = mesh.find_attribute(Domain::face, name);
  ASSERT_NE(attribute, nullptr) << name;
  EXPECT_EQ(attribute->values, values) << name;
  EXPECT_EQ(attribute->labels, labels) << name;
  EXPECT_EQ(attribute->interpolation, Interpolation::nearest) << name;
}

void expect_rich_obj(const Mesh& mesh) {
  ASSERT_EQ(mesh.vertex_count(), 5);
  ASSERT_EQ(mesh.face_count(), 3);
  EXPECT_EQ(mesh.faces.corners(), (std::vector<Index>{0, 1, 2, 3, 0, 1, 4, 1, 2, 4}));
  EXPECT_EQ(mesh.faces.offsets(), (std::vector<Index>{0, 4, 7, 10}));
  EXPECT_EQ(mesh.positions.row(4), Eigen::RowVector3d(0.5, 0.5, 1));

  const Attribute* colour = mesh.find_attribute(Domain::vertex, "colour");
  ASSERT_NE(colour, nullptr);
  EXPECT_EQ(colour->components, 3);
  EXPECT_EQ(colour->values[1], 0.25);
  const Attribute* uv = mesh.find_attribute(Domain::corner, "uv");
  ASSERT_NE(uv, nullptr);
  ASSERT_EQ(uv->values.size(), 20u);
  EXPECT_EQ(uv->values[0], 0);     // vertex 0 in the first face
  EXPECT_EQ(uv->values[8], 0.75);  // and in the second: a seam
  EXPECT_TRUE(std::isnan(uv->values[6]));
  EXPECT_TRUE(std::isnan(uv->values[14]));
  const Attribute* normal = mesh.find_attribute(Domain::corner, "normal");
  ASSERT_NE(normal, nullptr);
  EXPECT_EQ(normal->interpolation, Interpolation::direction);
  EXPECT_EQ(normal->values[2], 1);
  EXPECT_EQ(normal->values[3 * 4 + 1], -1);  // the relative index -1: the second vn line
  EXPECT_TRUE(std::isnan(normal->values[3 * 7]));
  expect_labels(mesh, "group", {0, 1, 1}, {"lower half", "upper"});
  expect_labels(mesh, "material", {0, 1, 1}, {"skin", "bones"});
  expect_labels(mesh, "object", {0, 0, 0}, {"Figure one"});
  expect_labels(mesh, "smoothing", {1, 0, 0}, {});
}

TEST(Obj, AllLineEndsReadAlikeAndComeBackByteForByte) {
  const TemporaryFolder folder;
  for (const char* line_end : {"\n", "\r\n", "\r"}) {
    for (const char* mark : {"", "\xEF\xBB\xBF"}) {
      for (const bool last_line_end : {true, false}) {
        std::string file = rich;
        if (!last_line_end) file.pop_back();
        file = mark + with_line_ends(file, line_end);
        const Mesh mesh = folder.mesh("in.obj", file);
        expect_rich_obj(mesh);
        EXPECT_EQ(folder.written(mesh, "out.obj"), file);
      }
    }
  }
}

TEST(Obj, AnEditChangesTheWordsOfMovedCoordinatesOnly) {
  const TemporaryFolder folder;
  for (const char* line_end : {"\n", "\r\n", "\r"}) {
    Mesh mesh = folder.mesh("in.obj", with_line_ends(rich, line_end));
    mesh.positions(1, 1) = 1.0 / 3;
    mesh.positions(3, 2) = -2.5e-7;
    std::string expected = rich;
    expected.replace(expected.find("v 1.000 0 0 1 1 1"), 17, "v 1.000 0.3333333333333333 0 1 1 1");
    expected.replace(expected.find("v 0 1e0 -0\t.1"), 13, "v 0 1e0 -2.5e-07\t.1");
    const std::string written = folder.written(mesh, "out.obj");
    EXPECT_EQ(written, with_line_ends(expected, line_end));
    EXPECT_TRUE(folder.mesh("again.obj", written).positions == mesh.positions);
  }
}

Attribute& normals_of(Mesh& mesh) {
  for (Attribute& attribute : mesh.attributes) {
    if (attribute.name == "normal") return attribute;
  }
  throw std::runtime_error("no normals");
}

TEST(Obj, ANormalThatAllItsCornersAgreeOnIsRewrittenInPlace) {
  const TemporaryFolder folder;
  Mesh mesh = folder.mesh("in.obj", rich);
  for (int corner = 0; corner < 4; ++corner) normals_of(mesh).values[3 * corner] = 0.6;
  std::string expected = rich;
  expected.replace(expected.find("vn 0 0 1"), 8, "vn 0.6 0 1");
  EXPECT_EQ(folder.written(mesh, "out.obj"), expected);
}

TEST(Obj, ANormalThatItsCornersDisagreeOnGetsNewLines) {
  const TemporaryFolder folder;
  Mesh mesh = folder.mesh("in.obj", rich);
  Attribute& normals = normals_of(mesh);
  normals.values[0] = 0.5;                                   // corner 0 leaves line 1, which others keep
  for (int c = 4; c < 7; ++c) normals.values[3 * c] = 0.25;  // all corners of line 2
  normals.values[3 * 6 + 2] = 0.75;                          // one of these differs again
  std::string expected = rich;
  expected.replace(expected.find("vn 0 -1 0\n"), 10, "vn 0.25 -1 0\nvn 0.5 0 1\nvn 0.25 -1 0.75\n");
  expected.replace(expected.find("1/1/1"), 5, "1/1/3");
  expected.replace(expected.find("-5/4/-1"), 7, "-5/4/-3");  // still line 2, two new ones lie between
  expected.replace(expected.find("5//2"), 4, "5//4");
  const std::string written = folder.written(mesh, "out.obj");
  EXPECT_EQ(written, expected);
  Mesh again = folder.mesh("again.obj", written);
  for (std::size_t k = 0; k < 3 * 7; ++k) EXPECT_EQ(normals_of(again).values[k], normals_of(mesh).values[k]);
  EXPECT_TRUE(again.faces == mesh.faces);
}

TEST(Obj, NormalsBetweenFacesMayBeSplitToo) {
  const TemporaryFolder folder;
  const std::string file =
      "v 0 0 0\nv 1 0 0\nv 0 1 0\nvn 0 0 1\nf 1//-1 2//-1 3//1\nvn 0 1 0\nf 3//-1 2//-2 1//2";
  Mesh mesh = folder.mesh("in.obj", file);
  normals_of(mesh).values = {.5, 0, 1, 0, 0, 1, 0, .5, 1, 0, 1, 0, 0, 0, 1, 0, 1, .5};
  Mesh again = folder.mesh("again.obj", folder.written(mesh, "out.obj"));
  EXPECT_EQ(normals_of(again).values, normals_of(mesh).values);
  EXPECT_TRUE(again.faces == mesh.faces);
}

TEST(Obj, RoundingDoesNotSplitNormals) {
  const TemporaryFolder folder;
  Mesh mesh = folder.mesh("in.obj", rich);
  for (int corner = 0; corner < 4; ++corner) normals_of(mesh).values[3 * corner] = 0.6 + 1e-16 * corner;
  EXPECT_EQ(folder.written(mesh, "out.obj").size(), rich.size() + 2);
}

TEST(Obj, HomogeneousAndColouredVerticesKeepTheirTails) {
  const TemporaryFolder folder;
  const std::string file = "v 0 0 0 1.0\nv 1 0 0 .5 .5 .5 .25\nv 0 1 0\n";
  Mesh mesh = folder.mesh("in.obj", file);
  const Attribute* colour = mesh.find_attribute(Domain::vertex, "colour");
  ASSERT_NE(colour, nullptr);
  ASSERT_EQ(colour->components, 4);
  EXPECT_TRUE(std::isnan(colour->values[0]));
  EXPECT_EQ(colour->values[7], 0.25);
  EXPECT_TRUE(std::isnan(colour->values[8]));
  mesh.positions.col(2).setConstant(2);
  EXPECT_EQ(folder.written(mesh, "out.obj"), "v 0 0 2 1.0\nv 1 0 2 .5 .5 .5 .25\nv 0 1 2\n");
}

TEST(Obj, FacesMayComeBeforeTheirVertices) {
  const TemporaryFolder folder;
  const std::string file = "f 1 2 3\nv 0 0 0\nv 1 0 0\nv 0 1 0\n";
  const Mesh mesh = folder.mesh("in.obj", file);
  EXPECT_EQ(mesh.faces.corners(), (std::vector<Index>{0, 1, 2}));
  EXPECT_EQ(folder.written(mesh, "out.obj"), file);
}

TEST(Obj, SpecialNumbersAreReadAsSuch) {
  const TemporaryFolder folder;
  const std::string file = "v nan -inf 1.#QNAN\n";
  const Mesh mesh = folder.mesh("in.obj", file);
  EXPECT_TRUE(std::isnan(mesh.positions(0, 0)));
  EXPECT_EQ(mesh.positions(0, 1), -std::numeric_limits<double>::infinity());
  EXPECT_TRUE(std::isnan(mesh.positions(0, 2)));
  EXPECT_EQ(folder.written(mesh, "out.obj"), file);
}

TEST(Obj, AMeshWithoutAFileIsComposedWithItsAttributes) {
  const TemporaryFolder folder;
  Mesh mesh = folder.mesh("in.obj", rich);
  mesh.source = nullptr;
  const std::string written = folder.written(mesh, "out.obj");
  EXPECT_EQ(written.find("mtllib"), std::string::npos);
  const Mesh again = folder.mesh("again.obj", written);
  expect_rich_obj(again);
  EXPECT_TRUE(again.positions == mesh.positions);
}

TEST(Obj, AChangedTopologyKeepsTheMaterialLibrary) {
  const TemporaryFolder folder;
  Mesh mesh = folder.mesh("in.obj", rich);
  Faces faces;
  faces.push_back(std::array<Index, 3>{0, 1, 2});
  mesh.faces = faces;
  mesh.attributes.clear();
  const std::string written = folder.written(mesh, "out.obj");
  EXPECT_EQ(written.find("mtllib skin and bones.mtl\n"), 0u);
  EXPECT_TRUE(folder.mesh("again.obj", written).faces == faces);
}

// Two triangles, of two materials.
std::string with_materials(const std::string& library) {
  return "mtllib " + library +
         "\nv 0 0 0\nv 1 0 0\nv 0 1 0\nv 1 1 0\nusemtl skin\nf 1 2 3\nusemtl hair\nf 3 2 4\n";
}

TEST(Obj, AJoinedMeshDefinesTheMaterialsOfBoth) {
  const TemporaryFolder folder;
  for (const char* sub : {"a", "b", "out"}) std::filesystem::create_directory(folder / sub);
  folder.file("a/one.mtl",
              "# of one\nnewmtl skin\nKd 1 0 0\nmap_Kd -s 1 1 1 -o 0.5 -bm 2 tex/the skin.png\n"
              "newmtl hair\nKd 0 0 1\nmap_Bump C:\\abs.png\nnewmtl unused\nKd 9 9 9\n");
  folder.file("b/my two.mtl",
              "newmtl skin\r\nKd 0 1 0\r\nmap_Kd ..\\b\\tex.png\r\nnewmtl hair\r\nbump /abs/b.png\r\n");
  const Mesh one = folder.mesh("a/one.obj", with_materials("one.mtl"));
  const Mesh two = folder.mesh("b/two.obj", with_materials("my two.mtl"));
  const WriteResult result = write_mesh(join(one, two).mesh, folder / "out/whole.obj");
  ASSERT_EQ(result.files,
            (std::vector<std::filesystem::path>{folder / "out/whole.obj", folder / "out/whole.mtl"}));
  EXPECT_TRUE(result.notes.empty());
  EXPECT_EQ(read_file(folder / "out/whole.mtl"),
            "# Materials, put together by meshgraft for whole.obj\n"
            "\nnewmtl skin\nKd 1 0 0\nmap_Kd -s 1 1 1 -o 0.5 -bm 2 ../a/tex/the skin.png\n"
            "\nnewmtl hair\nKd 0 0 1\nmap_Bump C:\\abs.png\n"
            "\nnewmtl skin_2\nKd 0 1 0\nmap_Kd ../b/tex.png\n"
            "\nnewmtl hair_2\nbump /abs/b.png\n");
  const std::string written = read_file(folder / "out/whole.obj");
  EXPECT_NE(written.find("\nmtllib whole.mtl\n"), std::string::npos) << written;
  EXPECT_EQ(written.find("mtllib", written.find("mtllib") + 1), std::string::npos);
  EXPECT_NE(written.find("\nusemtl hair_2\n"), std::string::npos) << written;

  // Joins once more, onto that result.
  const WriteResult again =
      write_mesh(join(read_mesh(folder / "out/whole.obj"), one).mesh, folder / "out/whole.obj");
  EXPECT_EQ(again.files.back(), folder / "out/whole_2.mtl") << "an input's library stays";
  const std::string third = read_file(folder / "out/whole_2.mtl");
  for (const char* name : {"skin\n", "hair_2\n", "skin_3\n", "hair_3\n"})
    EXPECT_NE(third.find(std::string("newmtl ") + name), std::string::npos) << third;
  EXPECT_NE(third.find("map_Kd ../b/tex.png"), std::string::npos) << third;
}

TEST(Obj, AMaterialLibraryReplacesOnlyOneOfItsKind) {
  const TemporaryFolder folder;
  folder.file("one.mtl", "newmtl skin\nKd 1 0 0\nnewmtl hair\n");
  folder.file("two.mtl", "newmtl skin\nKd 0 1 0\nnewmtl hair\n");
  folder.file("whole.mtl", "somebody's\n");
  const Mesh both =
      join(folder.mesh("one.obj", with_materials("one.mtl")), folder.mesh("two.obj", with_materials("two.mtl")))
          .mesh;
  EXPECT_EQ(write_mesh(both, folder / "whole.obj").files.back(), folder / "whole_2.mtl");
  EXPECT_EQ(write_mesh(both, folder / "whole.obj").files.back(), folder / "whole_2.mtl") << "its own";
  EXPECT_EQ(write_mesh(both, folder / "two.obj").files.back(), folder / "two_2.mtl");
  EXPECT_EQ(read_file(folder / "whole.mtl"), "somebody's\n");
  EXPECT_EQ(read_file(folder / "two.mtl"), "newmtl skin\nKd 0 1 0\nnewmtl hair\n");
}

TEST(Obj, NamesMaterialsThatAreNotDefined) {
  const TemporaryFolder folder;
  folder.file("one.mtl", "newmtl skin\n");
  const Mesh one = folder.mesh("one.obj", with_materials("one.mtl"));
  const Mesh two = folder.mesh("two.obj", with_materials("gone.mtl"));
  const WriteResult result = write_mesh(join(one, two).mesh, folder / "whole.obj");
  ASSERT_EQ(result.notes.size(), 1u);
  EXPECT_EQ(result.notes[0].id(), "io.library_not_read");
  EXPECT_EQ(result.notes[0].get<std::string>("library"), folder / "gone.mtl");
  EXPECT_EQ(result.notes[0].get<std::string>("reason"), "No such file or directory");
  const std::string written = read_file(folder / "whole.obj");
  EXPECT_NE(written.find("mtllib gone.mtl\nmtllib whole.mtl\n"), std::string::npos) << written;

  const Mesh three = folder.mesh("three.obj", with_materials("one.mtl"));
  const WriteResult undefined = write_mesh(join(one, three).mesh, folder / "three_times.obj");
  ASSERT_EQ(undefined.notes.size(), 2u);
  EXPECT_EQ(undefined.notes[0].id(), "io.material_undefined");
  EXPECT_EQ(undefined.notes[0].get<std::string>("material"), "hair");

  std::filesystem::create_directory(folder / "folder.mtl");
  const Mesh four = folder.mesh("four.obj", with_materials("folder.mtl"));
  const WriteResult no_file = write_mesh(join(one, four).mesh, folder / "whole.obj");
  ASSERT_EQ(no_file.notes.size(), 1u);
  EXPECT_EQ(no_file.notes[0].get<std::string>("reason"), "Is a directory");
}

TEST(Obj, FacesWithoutAMaterialTakeNobodysName) {
  const TemporaryFolder folder;
  const Mesh bare = folder.mesh("bare.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
  folder.file("part.mtl", "newmtl default\n");
  const Mesh part =
      folder.mesh("part.obj", "mtllib part.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nusemtl default\nf 1 2 3\n");
  const std::string written = folder.written(join(part, bare).mesh, "whole.obj");
  EXPECT_NE(written.find("usemtl default\nf 1 2 3\nusemtl default_2\nf 4 5 6\n"), std::string::npos) << written;
}

TEST(Obj, TellsWhatItCannotCarry) {
  const TemporaryFolder folder;
  const Mesh ply =
      folder.mesh("in.ply",
                  "ply\nformat ascii 1.0\ncomment TextureFile a.png\nelement vertex 3\nproperty float x\n"
                  "property float y\nproperty float z\nproperty float heat\nelement face 1\n"
                  "property list uchar int vertex_indices\nelement edge 2\nproperty int a\nend_header\n"
                  "0 0 0 1\n1 0 0 2\n0 1 0 3\n3 0 1 2\n1\n2\n");
  const WriteResult result = write_mesh(ply, folder / "out.obj");
  ASSERT_EQ(result.notes.size(), 3u);
  EXPECT_EQ(result.notes[0].id(), "io.left_out");
  EXPECT_EQ(result.notes[0].get<std::string>("file"), "in.ply");
  EXPECT_NE(result.notes[0].text().find("edge (2)"), std::string::npos) << result.notes[0].text();
  EXPECT_EQ(result.notes[1].get<std::string>("content"), "TextureFile a.png");
  EXPECT_EQ(result.notes[2].get<std::vector<std::string>>("attributes"), std::vector<std::string>{"heat"});

  folder.file("one.mtl", "newmtl skin\n");
  const Mesh obj = folder.mesh("one.obj", with_materials("one.mtl") + "l 1 2\nl 2 3\n");
  const WriteResult as_ply = write_mesh(obj, folder / "out.ply");
  ASSERT_EQ(as_ply.notes.size(), 2u);
  EXPECT_NE(as_ply.notes[0].text().find("l (2)"), std::string::npos) << as_ply.notes[0].text();
  EXPECT_EQ(as_ply.notes[1].id(), "io.materials_named_only");
  EXPECT_EQ(as_ply.notes[1].get<std::string>("library"), "one.mtl");

  std::filesystem::create_directory(folder / "far");
  const WriteResult moved = write_mesh(obj, folder / "far/one.obj");
  ASSERT_EQ(moved.notes.size(), 1u);
  EXPECT_EQ(moved.notes[0].id(), "io.library_to_copy");
  EXPECT_TRUE(write_mesh(obj, folder / "other.obj").notes.empty());
}

TEST(Obj, KnowsTheFilesBehindIt) {
  const TemporaryFolder folder;
  folder.file("one.mtl", "newmtl skin\nmap_Kd -clamp on skin.png\nmap_d gone.png\n");
  folder.file("skin.png", "png");
  folder.mesh("one.obj", with_materials("one.mtl"));
  EXPECT_EQ(files_behind(folder / "one.obj"),
            (std::vector<std::filesystem::path>{folder / "one.obj", folder / "one.mtl", folder / "skin.png"}));
  EXPECT_EQ(files_behind(folder / "gone.obj").size(), 1u);
}

TEST(Obj, ARefinedMeshKeepsTheMaterialLibrary) {
  const TemporaryFolder folder;
  const Mesh mesh = folder.mesh("in.obj", rich);
  const RefineResult refined = split_edges_at(mesh, std::vector<Index>{0});
  ASSERT_GT(refined.mesh.face_count(), mesh.face_count());
  const std::string written = folder.written(refined.mesh, "out.obj");
  EXPECT_EQ(written.find("mtllib skin and bones.mtl\n"), 0u);
}

TEST(Obj, AttributesSurviveTheWayThroughPlyAndBack) {
  const TemporaryFolder folder;
  const Mesh mesh = folder.mesh("in.obj", rich);
  const Mesh ply = folder.mesh("middle.ply", folder.written(mesh, "out.ply"));
  Mesh again = folder.mesh("again.obj", folder.written(ply, "out.obj"));
  EXPECT_TRUE(again.positions == mesh.positions);
  EXPECT_TRUE(again.faces == mesh.faces);
  expect_labels(again, "group", {0, 1, 1}, {"lower half", "upper"});
  expect_labels(again, "material", {0, 1, 1}, {"skin", "bones"});
  const Attribute* uv = again.find_attribute(Domain::corner, "uv");
  ASSERT_NE(uv, nullptr);
  EXPECT_EQ(uv->values[8], 0.75);
  const Attribute* colour = again.find_attribute(Domain::vertex, "colour");
  ASSERT_NE(colour, nullptr);
  EXPECT_NEAR(colour->values[1], 0.25, 0.5 / 255);
}

TEST(Obj, FacesBeforeTheFirstGroupHaveNone) {
  const TemporaryFolder folder;
  const std::string file = "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\ng late\nf 3 2 1\n";
  const Mesh mesh = folder.mesh("in.obj", file);
  const Mesh ply = folder.mesh("middle.ply", folder.written(mesh, "out.ply"));
  for (const Mesh* each : {&mesh, &ply}) {
    const Attribute* group = each->find_attribute(Domain::face, "group");
    ASSERT_NE(group, nullptr);
    EXPECT_TRUE(std::isnan(group->values[0]));
    EXPECT_EQ(group->values[1], 0);
    EXPECT_EQ(group->labels, std::vector<std::string>{"late"});
  }
  EXPECT_EQ(folder.written(ply, "again.ply"), read_file(folder / "middle.ply"));
}

TEST(Obj, AgreesWithTinyobjloader) {
  const TemporaryFolder folder;
  const std::string file =
      "v 0 0 0\nv 1.5 0 0\nv 1 1e-3 0\nv 0 1 0\nvt 0 0\nvt .5 0\nvt 0 .25\nvn 0 0 1\n"
      "f 1/1/1 2/2/1 3/3/1 4/1/1\nv 3 3 3\nf -1/-1/-1 -2/-2/-1 -3/-3/-1\n";
  const Mesh mesh = folder.mesh("in.obj", file);
  tinyobj::ObjReaderConfig config;
  config.triangulate = false;
  tinyobj::ObjReader reader;
  ASSERT_TRUE(reader.ParseFromString(file, "", config)) << reader.Error();
  const tinyobj::attrib_t& other = reader.GetAttrib();
  ASSERT_EQ(other.vertices.size(), static_cast<std::size_t>(3 * mesh.vertex_count()));
  for (std::size_t k = 0; k < other.vertices.size(); ++k) {
    EXPECT_NEAR(mesh.positions.data()[k], other.vertices[k], 1e-6);
  }
  const tinyobj::mesh_t& shape = reader.GetShapes().at(0).mesh;
  ASSERT_EQ(shape.indices.size(), static_cast<std::size_t>(mesh.faces.corner_count()));
  const Attribute* uv = mesh.find_attribute(Domain::corner, "uv");
  ASSERT_NE(uv, nullptr);
  for (std::size_t c = 0; c < shape.indices.size(); ++c) {
    EXPECT_EQ(mesh.faces.corners()[c], shape.indices[c].vertex_index);
    EXPECT_NEAR(uv->values[2 * c], other.texcoords[2 * shape.indices[c].texcoord_index], 1e-6);
    EXPECT_NEAR(uv->values[2 * c + 1], other.texcoords[2 * shape.indices[c].texcoord_index + 1], 1e-6);
  }
}

struct BadObj {
  const char* what;
  std::string content;
  const char* id;
  std::vector<std::string> words;  // that the message contains
};

TEST(Obj, ContinuedLinesAreOneWhateverTheyHold) {
  const TemporaryFolder folder;
  for (const std::string name :
       {"o on\\\nv 9 9 9", "usemtl a#b\\\nv 9 9 9", "g a \\\n b\\\r\nc", "q 1#2\\\n3"}) {
    SCOPED_TRACE(name);
    const std::string content = name + "\nv 0 0 0\nv 1 0 0\nv 0 1 0\n# C:\\\nf 1 2 3\n";
    Mesh mesh = folder.mesh("in.obj", content);
    EXPECT_EQ(mesh.vertex_count(), 3);
    EXPECT_EQ(folder.written(mesh, "same.obj"), content);
    mesh.positions.array() += 1;
    const Mesh again = folder.mesh("again.obj", folder.written(mesh, "moved.obj"));
    EXPECT_EQ(again.positions, mesh.positions);
  }
}

TEST(Obj, ABackslashMayBeTheLastCharacter) {
  const TemporaryFolder folder;
  const std::string content = "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3 \\";
  const Mesh mesh = folder.mesh("in.obj", content);
  EXPECT_EQ(mesh.face_count(), 1);
  EXPECT_EQ(folder.written(mesh, "same.obj"), content);
}

TEST(Obj, BadFilesAreNamedWithPlaceAndRemedy) {
  const std::string triangle = "v 0 0 0\nv 1 0 0\nv 0 1 0\n";
  const std::vector<BadObj> bad_obj_files = {
      {"index 0", triangle + "f 0 1 2\n", "io.index_zero", {"line 4", "index 0", "count from 1"}},
      {"out of range", triangle + "f 1 2 4\n", "io.index_out_of_range", {"line 4", "index 4", "3 'v' lines"}},
      {"relative out of range",
       triangle + "f -1 -2 -4\n",
       "io.index_before_first",
       {"line 4", "index -4", "3 'v' lines before it"}},
      {"relative to later lines",
       "f -1 -2 -3\n" + triangle,
       "io.index_before_first",
       {"line 1", "index -1", "0 'v' lines before it"}},
      {"uv out of range",
       triangle + "vt 0 0\nf 1/1 2/2 3/1\n",
       "io.index_out_of_range",
       {"line 5", "index 2", "1 'vt' lines"}},
      {"normal out of range",
       triangle + "f 1//1 2//1 3//1\n",
       "io.index_out_of_range",
       {"line 4", "index 1", "0 'vn' lines"}},
      {"huge index", triangle + "f 1 2 5000000000\n", "io.index_out_of_range", {"line 4", "5000000000"}},
      {"endless index",
       triangle + "f 1 2 99999999999999999999\n",
       "io.bad_corner",
       {"line 4", "99999999999999999999"}},
      {"no index", triangle + "f 1 2 x\n", "io.bad_corner", {"line 4", "'x'"}},
      {"four parts", triangle + "f 1/1/1/1 2 3\n", "io.bad_corner", {"line 4", "'1/1/1/1'"}},
      {"empty face", triangle + "f\n", "io.missing_value", {"line 4", "'v' of 'f'"}},
      {"after CR", with_line_ends(triangle + "f 1 2 x\n", "\r"), "io.bad_corner", {"line 4", "'x'"}},
      {"after CRLF", with_line_ends(triangle + "f 1 2 x\n", "\r\n"), "io.bad_corner", {"line 4", "'x'"}},
      {"two coordinates", "v 0 0 0\nv 1 2\n", "io.missing_value", {"line 2", "'z' of 'v'"}},
      {"too many values", "v 1 2 3 4 5 6 7 8\n", "io.extra_values", {"line 1", "'v'"}},
      {"no number", "v 0 zero 0\n", "io.not_a_number", {"line 1", "'zero'"}},
      {"decimal comma", "v 0,5 1 2\n", "io.decimal_comma", {"line 1", "'0,5'", "decimal point"}},
      {"too large", "v 1e400 1 2\n", "io.number_out_of_range", {"line 1", "'1e400'", "range"}},
      {"short normal", "vn 1 2\n", "io.missing_value", {"line 1", "'z' of 'vn'"}},
      {"empty uv", "vt\n", "io.missing_value", {"line 1", "'u' of 'vt'"}},
      {"no vertices", "# nothing\n", "io.no_vertices", {"no vertices"}},
      {"not text", std::string("v 0 0 0\n\0\1\2", 11), "io.not_text", {"byte 8", "not text"}},
  };
  const TemporaryFolder folder;
  for (const BadObj& bad : bad_obj_files) {
    SCOPED_TRACE(bad.what);
    const auto path = folder.file("bad.obj", bad.content);
    std::vector<std::string> words = bad.words;
    words.push_back("bad.obj");
    const Error error = expect_error([&] { read_mesh(path); }, bad.id, words);
    EXPECT_EQ(error.code(), ErrorCode::input);
    EXPECT_FALSE(error.remedy().empty());
  }
}

TEST(Obj, DamagedBytesNeverCrash) {
  const TemporaryFolder folder;
  for (std::size_t at = 0; at < rich.size(); ++at) {
    for (const char damage : {'\xFF', '\\', '-', '/', '9', '\r', ' '}) {
      std::string damaged = rich;
      damaged[at] = damage;
      const auto path = folder.file("damaged.obj", damaged);
      try {
        const Mesh mesh = read_mesh(path);
        if (at % 16 == 0) {
          EXPECT_EQ(folder.written(mesh, "out.obj"), damaged);
        }
      } catch (const Error& error) {
        EXPECT_EQ(error.code(), ErrorCode::input) << error.what();
      }
    }
  }
}

}  // namespace
}  // namespace meshgraft
