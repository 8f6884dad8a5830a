#pragma once

#include <cmath>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include <meshgraft/mesh/mesh.h>

/// OBJ files for tests.
namespace meshgraft::test {

/// A cube's corner with everything: seams, shared normals, groups, relative indices, lines of other kinds.
inline const std::string rich_obj =
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

inline void expect_labels(const Mesh& mesh, const char* name, const std::vector<double>& values,
                          const std::vector<std::string>& labels) {
  const Attribute* attribute = mesh.find_attribute(Domain::face, name);
  ASSERT_NE(attribute, nullptr) << name;
  EXPECT_EQ(attribute->values, values) << name;
  EXPECT_EQ(attribute->labels, labels) << name;
  EXPECT_EQ(attribute->interpolation, Interpolation::nearest) << name;
}

inline void expect_rich_obj(const Mesh& mesh) {
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

}  // namespace meshgraft::test
