
#include <cmath>
#include <limits>
#include <numeric>

#include <gtest/gtest.h>

#include <meshgraft/mesh/topology.h>

#include "mesh/join.h"
#include "mesh/shapes.h"

namespace meshgraft {
namespace {

constexpr double none = std::numeric_limits<double>::quiet_NaN();

Mesh triangle() { return shapes::polygons({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, {{0, 1, 2}}); }

Mesh with(Mesh mesh, std::vector<Attribute> attributes) {
  mesh.attributes = std::move(attributes);
  return mesh;
}

Attribute labels(const std::string& name, std::vector<double> values, std::vector<std::string> texts) {
  return {.name = name,
          .domain = Domain::face,
          .interpolation = Interpolation::nearest,
          .type = ScalarType::int32,
          .values = std::move(values),
          .labels = std::move(texts)};
}

// Expects equal values, and missing ones (NaN) where they are expected.
void expect_values(const Attribute& attribute, const std::vector<double>& expected) {
  ASSERT_EQ(attribute.values.size(), expected.size()) << attribute.name;
  for (std::size_t k = 0; k < expected.size(); ++k) {
    if (std::isnan(expected[k])) {
      EXPECT_TRUE(std::isnan(attribute.values[k])) << attribute.name << " " << k;
    } else {
      EXPECT_EQ(attribute.values[k], expected[k]) << attribute.name << " " << k;
    }
  }
}

std::string label_of(const Attribute& attribute, Index face) {
  return attribute.labels.at(static_cast<std::size_t>(attribute.values.at(face)));
}

TEST(Join, KeepsBothInOrder) {
  const std::vector<Mesh> meshes{shapes::cube(), shapes::tube(7, 3), shapes::torus(8, 5, true), triangle(),
                                 Mesh{}};
  for (const Mesh& a : meshes) {
    for (const Mesh& b : meshes) {
      const JoinResult joined = join(a, b);
      ASSERT_EQ(joined.mesh.vertex_count(), a.vertex_count() + b.vertex_count());
      ASSERT_EQ(joined.mesh.face_count(), a.face_count() + b.face_count());
      for (Index v = 0; v < a.vertex_count(); ++v) {
        EXPECT_EQ(joined.first.new_index[v], v);
        EXPECT_EQ(joined.mesh.positions.row(v), a.positions.row(v));
      }
      for (Index v = 0; v < b.vertex_count(); ++v) {
        ASSERT_EQ(joined.second.new_index[v], a.vertex_count() + v);
        EXPECT_EQ(joined.mesh.positions.row(a.vertex_count() + v), b.positions.row(v));
      }
      EXPECT_EQ(summarise_topology(joined.mesh).euler_characteristic,
                summarise_topology(a).euler_characteristic + summarise_topology(b).euler_characteristic);
    }
  }
}

TEST(Join, LeavesIndicesOutOfRangeOutOfRange) {
  Mesh first = triangle();
  first.faces.push_back(std::vector<Index>{0, 1, 3});  // must not become the second mesh's first vertex
  Mesh second = triangle();
  second.faces.push_back(std::vector<Index>{0, 1, -2});
  const Mesh mesh = join(first, second).mesh;
  EXPECT_EQ(mesh.faces[1][2], -1);
  EXPECT_EQ(mesh.faces[3][2], -1);
}

TEST(Join, MarksWhatOneLacksAsMissing) {
  const Mesh a = with(triangle(), {{.name = "temperature", .values = {1, 2, 3}}});
  const Mesh b = with(triangle(), {labels("smoothing", {4}, {})});
  const Mesh mesh = join(a, b).mesh;
  ASSERT_EQ(mesh.attributes.size(), 2);
  expect_values(mesh.attributes[0], {1, 2, 3, none, none, none});
  expect_values(mesh.attributes[1], {none, 4});
}

TEST(Join, BringsColoursOfDifferentFilesTogether) {
  const Mesh bytes = with(triangle(), {{.name = "colour",
                                        .type = ScalarType::uint8,
                                        .components = 3,
                                        .values = {255, 0, 51, 0, 0, 0, none, none, none}}});
  const Mesh fractions = with(triangle(), {{.name = "colour",
                                            .type = ScalarType::float32,
                                            .components = 4,
                                            .values = {0.5, 1, 0, 0.25, 0, 0, 0, 1, none, none, none, none}}});
  const Mesh mesh = join(bytes, fractions).mesh;
  const Attribute* colour = mesh.find_attribute(Domain::vertex, "colour");
  ASSERT_NE(colour, nullptr);
  EXPECT_EQ(colour->components, 4);
  EXPECT_EQ(colour->type, ScalarType::float32);
  expect_values(*colour, {1,   0, 0.2, 1,    0, 0, 0, 1, none, none, none, none,  //
                          0.5, 1, 0,   0.25, 0, 0, 0, 1, none, none, none, none});
  const Mesh same = join(bytes, bytes).mesh;
  EXPECT_EQ(same.attributes.front().type, ScalarType::uint8);
  EXPECT_EQ(same.attributes.front().values[9], 255);
}

TEST(Join, MakesValuesPerCornerWhereOneHasThem) {
  const Mesh a = with(triangle(), {{.name = "uv", .components = 2, .values = {0, 1, 2, 3, 4, 5}}});
  Mesh b = with(triangle(),
                {{.name = "uv", .domain = Domain::corner, .components = 2, .values = {6, 7, 8, 9, 10, 11}}});
  const std::vector<double> expected{0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11};
  const Mesh mesh = join(a, b).mesh;
  ASSERT_EQ(mesh.attributes.size(), 1);
  EXPECT_EQ(mesh.attributes[0].domain, Domain::corner);
  expect_values(mesh.attributes[0], expected);
  EXPECT_EQ(join(b, a).mesh.attributes[0].domain, Domain::corner);
}

TEST(Join, RenamesWhatDoesNotMatch) {
  const Mesh a = with(triangle(), {{.name = "weight", .values = {1, 2, 3}}});
  const Mesh b = with(triangle(), {{.name = "weight", .components = 2, .values = {1, 2, 3, 4, 5, 6}}});
  const Mesh mesh = join(a, b).mesh;
  ASSERT_EQ(mesh.attributes.size(), 2);
  EXPECT_EQ(mesh.attributes[1].name, "weight_2");
  expect_values(mesh.attributes[1], {none, none, none, none, none, none, 1, 2, 3, 4, 5, 6});
}

TEST(Join, TellsMaterialsOfOneNameApart) {
  Mesh a = shapes::cube(), b = shapes::cube();
  a.attributes = {labels("material", {0, 0, 1, 1, 1, none}, {"skin", "hair"}),
                  labels("group", {0, 0, 0, 0, 0, 0}, {"body"})};
  b.attributes = {labels("material", {0, 1, 2, 2, 2, 2}, {"skin", "skin_2", "gold"}),
                  labels("group", {0, 0, 0, 1, 1, 1}, {"body", "hat"})};
  const JoinResult joined = join(a, b);
  const Attribute& material = *joined.mesh.find_attribute(Domain::face, "material");
  EXPECT_EQ(label_of(material, 0), "skin");
  EXPECT_EQ(label_of(material, 2), "hair");
  EXPECT_TRUE(std::isnan(material.values[5]));
  EXPECT_EQ(label_of(material, 6), "skin_3");  // the second has a skin_2 of its own
  EXPECT_EQ(label_of(material, 7), "skin_2");
  EXPECT_EQ(label_of(material, 8), "gold");
  ASSERT_EQ(joined.notes.size(), 1);
  EXPECT_EQ(joined.notes[0].id(), "mesh.renamed_label");
  EXPECT_EQ(joined.notes[0].get<std::string>("new_name"), "skin_3");
  const Attribute& group = *joined.mesh.find_attribute(Domain::face, "group");
  EXPECT_EQ(group.labels, (std::vector<std::string>{"body", "hat"}));
  EXPECT_EQ(label_of(group, 6), "body");
  EXPECT_EQ(label_of(group, 9), "hat");
}

TEST(Join, KeepsMaterialsOfOneFileOne) {
  Mesh a = with(triangle(), {labels("material", {0}, {"skin"})});
  a.source = std::make_shared<SourceDocument>();
  const Mesh b = a;
  const JoinResult joined = join(a, b);
  EXPECT_EQ(joined.mesh.attributes[0].labels, (std::vector<std::string>{"skin"}));
  EXPECT_TRUE(joined.notes.empty());
}

TEST(Join, NamesNumberedMaterials) {
  const Mesh a = with(triangle(), {labels("material", {3}, {})});
  const JoinResult joined = join(a, a);
  const Attribute& material = joined.mesh.attributes[0];
  EXPECT_EQ(label_of(material, 0), "material_3");
  EXPECT_EQ(label_of(material, 1), "material_3_2");
}

}  // namespace
}  // namespace meshgraft
