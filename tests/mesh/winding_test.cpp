
#include <cmath>
#include <numbers>

#include <gtest/gtest.h>

#include <meshgraft/mesh/topology.h>

#include "mesh/winding.h"
#include "shapes.h"
#include "support/mesh_families.h"

namespace meshgraft {
namespace {

TEST(TurnedOver, TwiceIsTheGivenMesh) {
  for (Mesh mesh : {shapes::cube(), shapes::torus(), shapes::tube(7, 3, true)}) {
    Attribute& uv = mesh.attributes.emplace_back();
    uv = {.name = "uv", .domain = Domain::corner};
    Attribute normal{.name = "normal", .domain = Domain::face, .components = 3};
    for (Index c = 0; c < mesh.faces.corner_count(); ++c) uv.values.push_back(mesh.faces.corners()[c]);
    for (Index k = 0; k < 3 * mesh.face_count(); ++k) normal.values.push_back(k);
    mesh.attributes.push_back(normal);

    const Mesh turned = turned_over(mesh), twice = turned_over(turned);
    EXPECT_EQ(twice.faces, mesh.faces);
    for (std::size_t k = 0; k < mesh.attributes.size(); ++k)
      EXPECT_EQ(twice.attributes[k].values, mesh.attributes[k].values);
    for (Index c = 0; c < turned.faces.corner_count(); ++c)
      EXPECT_EQ(turned.attributes[0].values[c], turned.faces.corners()[c]) << "values go with their corners";
    for (std::size_t k = 0; k < normal.values.size(); ++k)
      EXPECT_EQ(turned.attributes[1].values[k], -normal.values[k]);
  }
}

TEST(EnclosedVolume, ChangesItsSignWithTheOrientation) {
  for (const test::TestMesh& family : test::mesh_families()) {
    SCOPED_TRACE(family.name);
    Mesh mesh = make_mesh(family.positions, family.triangles);
    const double volume = enclosed_volume(mesh);
    EXPECT_LE(volume, 1) << "no surface encloses more than a ball";
    if (summarise_topology(mesh).closed) {
      EXPECT_GT(volume, 0);
    }
    EXPECT_NEAR(enclosed_volume(turned_over(mesh)), -volume, 1e-6);
    mesh.positions *= 1e-3;
    EXPECT_NEAR(enclosed_volume(mesh), volume, 1e-6);
  }
}

TEST(EnclosedVolume, IsNearOneForBalls) {
  double before = 0;
  for (int level = 0; level < 4; ++level) {
    const test::TestMesh ball = test::icosphere(level);
    const double volume = enclosed_volume(make_mesh(ball.positions, ball.triangles));
    EXPECT_GT(volume, before);
    before = volume;
  }
  EXPECT_GT(before, 0.98);
  EXPECT_EQ(enclosed_volume(shapes::grid(3, 3)), 0);
}

}  // namespace
}  // namespace meshgraft
