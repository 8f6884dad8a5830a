#include "merge/seam_attributes.h"

#include <cmath>
#include <limits>

#include <gtest/gtest.h>

#include <meshgraft/mesh/normals.h>

#include "merge/seam_scenes.h"

namespace meshgraft {
namespace {

constexpr double missing = std::numeric_limits<double>::quiet_NaN();

/// Takes a scene's strip off: returns its triangles and leaves the faces of target and source.
std::vector<std::array<Index, 3>> take_strip(test::SeamScene& scene) {
  std::vector<std::array<Index, 3>> strip;
  Faces kept;
  for (Index f = 0; f < scene.mesh.face_count(); ++f) {
    const auto face = scene.mesh.faces[f];
    if (f < scene.strip_begin()) {
      kept.push_back(face);
    } else {
      strip.push_back({face[0], face[1], face[2]});
    }
  }
  scene.mesh.faces = kept;
  return strip;
}

std::string group_of(const Mesh& mesh, Index face) {
  const Attribute& groups = *mesh.find_attribute(Domain::face, "group");
  return groups.labels.at(static_cast<std::size_t>(groups.values.at(face)));
}

TEST(SeamAttributes, EveryFaceBelongsToItsSide) {
  for (test::SeamScene scene : test::seam_scenes(0)) {
    const auto strip = take_strip(scene);
    Attribute groups{.name = "group", .domain = Domain::face, .labels = {"lid"}};
    groups.values.assign(static_cast<std::size_t>(scene.mesh.face_count()), missing);
    groups.values[1] = 0;
    for (const bool grouped : {false, true}) {
      Mesh mesh = scene.mesh;
      if (grouped) mesh.attributes.push_back(groups);
      label_sides(mesh, scene.layout);
      add_strip(mesh, strip, std::vector<Index>(strip.size(), 0));
      ASSERT_EQ(mesh.face_count(), scene.strip_begin() + static_cast<Index>(strip.size()));
      for (Index f = 0; f < mesh.face_count(); ++f) {
        const SeamSide side = scene.layout.side_of_face(f);
        const std::string expected = side == SeamSide::strip    ? "seam"
                                     : grouped && f == 1        ? "lid"
                                     : side == SeamSide::target ? "target"
                                                                : "source";
        EXPECT_EQ(group_of(mesh, f), expected) << scene.name;
      }
    }
  }
}

TEST(SeamAttributes, TheStripTakesFaceValuesOfItsNeighboursAndNoCornerValues) {
  for (test::SeamScene scene : test::seam_scenes(0)) {
    const auto strip = take_strip(scene);
    Mesh& mesh = scene.mesh;
    Attribute material{.name = "material", .domain = Domain::face, .interpolation = Interpolation::nearest},
        uv{.name = "uv", .domain = Domain::corner, .components = 2};
    for (Index f = 0; f < mesh.face_count(); ++f) material.values.push_back(f % 5);
    for (Index c = 0; c < 2 * mesh.faces.corner_count(); ++c) uv.values.push_back(c);
    mesh.attributes = {material, uv};
    label_sides(mesh, scene.layout);
    std::vector<Index> neighbour;
    for (std::size_t k = 0; k < strip.size(); ++k)
      neighbour.push_back(static_cast<Index>(3 * k) % scene.layout.target_faces);
    add_strip(mesh, strip, neighbour);
    const Attribute &materials = *mesh.find_attribute(Domain::face, "material"),
                    &uvs = *mesh.find_attribute(Domain::corner, "uv");
    ASSERT_EQ(static_cast<Index>(materials.values.size()), mesh.face_count()) << scene.name;
    ASSERT_EQ(static_cast<Index>(uvs.values.size()), 2 * mesh.faces.corner_count()) << scene.name;
    for (std::size_t k = 0; k < strip.size(); ++k)
      EXPECT_EQ(materials.values[material.values.size() + k], neighbour[k] % 5);
    for (std::size_t c = 0; c < uvs.values.size(); ++c) {
      if (c < uv.values.size()) {
        EXPECT_EQ(uvs.values[c], uv.values[c]);
      }
      if (c >= uv.values.size()) {
        EXPECT_TRUE(std::isnan(uvs.values[c]));
      }
    }
  }
}

Attribute normal_attribute(Domain domain, const Points& values) {
  Attribute normals{
      .name = "normal", .domain = domain, .interpolation = Interpolation::direction, .components = 3};
  normals.values.assign(values.data(), values.data() + values.size());
  return normals;
}

TEST(SeamAttributes, NormalsAreRenewedOnTheStripAndKeptWhereNothingMoved) {
  for (test::SeamScene scene : test::seam_scenes(0.2)) {
    SCOPED_TRACE(scene.name);
    const Points given = vertex_normals(scene.mesh).rowwise().reverse();  // not those of the surface
    scene.mesh.attributes = {normal_attribute(Domain::vertex, given)};
    renew_normals(scene.mesh, scene.layout, scene.mesh.positions);
    const Points fresh = vertex_normals(scene.mesh);
    const Attribute& normals = *scene.mesh.find_attribute(Domain::vertex, "normal");
    for (Index v = 0; v < scene.mesh.vertex_count(); ++v) {
      const Eigen::Map<const Eigen::RowVector3d> normal(normals.values.data() + 3 * v);
      if (scene.is_on_strip(v)) {
        EXPECT_LT((normal - fresh.row(v)).norm(), 1e-12);
      } else {
        EXPECT_EQ(Eigen::RowVector3d(normal), given.row(v));
      }
    }
  }
}

TEST(SeamAttributes, NormalsOfTheStripsFacesAreItsOwn) {
  for (test::SeamScene scene : test::seam_scenes(0.2)) {
    scene.mesh.attributes = {
        normal_attribute(Domain::face, Points::Constant(scene.mesh.face_count(), 3, missing))};
    renew_normals(scene.mesh, scene.layout, scene.mesh.positions);
    const Attribute& normals = *scene.mesh.find_attribute(Domain::face, "normal");
    for (Index f = scene.strip_begin(); f < scene.mesh.face_count(); ++f) {
      const Eigen::Map<const Eigen::RowVector3d> normal(normals.values.data() + 3 * f);
      const auto face = scene.mesh.faces[f];
      EXPECT_NEAR(normal.norm(), 1, 1e-12) << scene.name;
      for (int c = 0; c < 3; ++c)
        EXPECT_NEAR(normal.dot(scene.mesh.positions.row(face[c]) - scene.mesh.positions.row(face[(c + 1) % 3])),
                    0, 1e-12);
    }
  }
}

TEST(SeamAttributes, MeshesWithoutNormalsGetNone) {
  test::SeamScene scene = test::seam_scenes(0.2)[0];
  renew_normals(scene.mesh, scene.layout, scene.smooth);
  EXPECT_TRUE(scene.mesh.attributes.empty());
}

}  // namespace
}  // namespace meshgraft
