#include <cmath>
#include <stdexcept>
#include <string>

#include <gtest/gtest.h>

#include "damage.h"
#include "obj_files.h"
#include "temporary_folder.h"

namespace meshgraft::test {
namespace {

TEST(Obj, AnEditChangesTheWordsOfMovedCoordinatesOnly) {
  const TemporaryFolder folder;
  for (const char* line_end : {"\n", "\r\n", "\r"}) {
    Mesh mesh = folder.mesh("in.obj", with_line_ends(rich_obj, line_end));
    mesh.positions(1, 1) = 1.0 / 3;
    mesh.positions(3, 2) = -2.5e-7;
    std::string expected = rich_obj;
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
  Mesh mesh = folder.mesh("in.obj", rich_obj);
  for (int corner = 0; corner < 4; ++corner) normals_of(mesh).values[3 * corner] = 0.6;
  std::string expected = rich_obj;
  expected.replace(expected.find("vn 0 0 1"), 8, "vn 0.6 0 1");
  EXPECT_EQ(folder.written(mesh, "out.obj"), expected);
}

TEST(Obj, ANormalThatItsCornersDisagreeOnGetsNewLines) {
  const TemporaryFolder folder;
  Mesh mesh = folder.mesh("in.obj", rich_obj);
  Attribute& normals = normals_of(mesh);
  normals.values[0] = 0.5;                                   // corner 0 leaves line 1, which others keep
  for (int c = 4; c < 7; ++c) normals.values[3 * c] = 0.25;  // all corners of line 2
  normals.values[3 * 6 + 2] = 0.75;                          // one of these differs again
  std::string expected = rich_obj;
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
  Mesh mesh = folder.mesh("in.obj", rich_obj);
  for (int corner = 0; corner < 4; ++corner) normals_of(mesh).values[3 * corner] = 0.6 + 1e-16 * corner;
  EXPECT_EQ(folder.written(mesh, "out.obj").size(), rich_obj.size() + 2);
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

TEST(Obj, AMeshWithoutAFileIsComposedWithItsAttributes) {
  const TemporaryFolder folder;
  Mesh mesh = folder.mesh("in.obj", rich_obj);
  mesh.source = nullptr;
  const std::string written = folder.written(mesh, "out.obj");
  EXPECT_EQ(written.find("mtllib"), std::string::npos);
  const Mesh again = folder.mesh("again.obj", written);
  expect_rich_obj(again);
  EXPECT_TRUE(again.positions == mesh.positions);
}

TEST(Obj, AttributesSurviveTheWayThroughPlyAndBack) {
  const TemporaryFolder folder;
  const Mesh mesh = folder.mesh("in.obj", rich_obj);
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

}  // namespace
}  // namespace meshgraft::test
