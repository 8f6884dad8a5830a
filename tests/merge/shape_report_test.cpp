#include "merge/shape_report.h"

#include <cmath>

#include <gtest/gtest.h>

#include <meshgraft/mesh/topology.h>

#include "merge/closed_curves.h"
#include "support/mesh_families.h"

namespace meshgraft {
namespace {

/// A family whose head is beyond the influence radius.
struct ShapeScene {
  test::Scene scene;
  std::vector<Index> component;

  explicit ShapeScene(test::TestMesh mesh) : scene(test::make_scene(std::move(mesh), 0.3, 0.5)) {
    component = connected_components(make_mesh(scene.mesh.positions, scene.mesh.triangles));
  }
  ShapeReport measure(const Points& grafted) const {
    return measure_shape(scene.mesh.positions, grafted, scene.mesh.triangles, scene.head, component);
  }
};

std::vector<ShapeScene> shape_scenes() {
  std::vector<ShapeScene> scenes;
  for (const test::TestMesh& mesh :
       {test::bumpy_sphere(2), test::tube(10, 16), test::torus(9, 16), test::bar(2, 9),
        test::irregular_grid(14, 9), test::minute(test::bumpy_sphere(2)),
        test::with_isolated_vertices(test::irregular_grid(12, 8))})
    scenes.emplace_back(mesh);
  return scenes;
}

TEST(ShapeReport, OfASimilarityIsThatSimilarityWithoutDistortion) {
  for (const ShapeScene& test : shape_scenes())
    for (const Eigen::Affine3d& map : test::similarities()) {
      SCOPED_TRACE(test.scene.mesh.name);
      const ShapeReport report = test.measure(test::mapped(test.scene.mesh.positions, map));
      EXPECT_LT((report.similarity.scale * report.similarity.rotation - map.linear()).norm(),
                1e-8 * map.linear().norm());
      EXPECT_LT((report.similarity.translation - map.translation()).norm(),
                1e-8 * (1 + map.translation().norm()));
      for (const double scale : report.scales) EXPECT_NEAR(scale, report.similarity.scale, 1e-8 * scale);
      EXPECT_LT(report.distance_rel, 1e-7);  // the shift rounds the coordinates of minute meshes
      EXPECT_NEAR(report.smallest_singular_p5, 1, 1e-6);
    }
}

TEST(ShapeReport, SeesASqueezeNearTheLoops) {
  for (const ShapeScene& test : shape_scenes()) {
    SCOPED_TRACE(test.scene.mesh.name);
    Eigen::Index axis = 0;
    const Points& rest = test.scene.mesh.positions;
    (rest.colwise().maxCoeff() - rest.colwise().minCoeff()).maxCoeff(&axis);
    for (const double squeeze : {0.5, 0.25}) {
      Points grafted = rest;  // everything below the head is shortened towards it
      double head = 1e30;
      for (const Index v : test.scene.head) head = std::min(head, rest(v, axis));
      for (Index v = 0; v < test.scene.mesh.size(); ++v)
        if (rest(v, axis) < head) grafted(v, axis) = head + squeeze * (rest(v, axis) - head);
      const ShapeReport report = test.measure(grafted);
      EXPECT_LT(report.distance_rel, 1e-12);  // the far part is as it was
      EXPECT_GE(report.smallest_singular_p5, squeeze - 1e-9);
      EXPECT_LT(report.smallest_singular_p5, squeeze + 0.3);
    }
  }
}

TEST(ShapeReport, MeasuresTheFarPartsDistanceFromItsSimilarity) {
  for (const ShapeScene& test : shape_scenes()) {
    double last = 0;
    for (const double amount : {0.01, 0.05, 0.2}) {
      Points grafted = test.scene.mesh.positions;
      const double size = test.scene.mesh.box_diagonal();
      for (Index v = 0; v < test.scene.mesh.size(); ++v) grafted(v, v % 3) += amount * size * std::sin(7.0 * v);
      const double distance = test.measure(grafted).distance_rel;
      EXPECT_GT(distance, last) << test.scene.mesh.name;
      last = distance;
    }
  }
}

TEST(ShapeReport, IsTheWorstOfAllComponents) {
  const test::TestMesh one = test::bumpy_sphere(2), other = test::icosphere(1);
  Points rest(one.size() + other.size(), 3);
  rest << one.positions, other.positions.array() + 5;
  Triangles triangles(one.triangles.rows() + other.triangles.rows(), 3);
  triangles << one.triangles, other.triangles.array() + one.size();
  const std::vector<Index> component = connected_components(make_mesh(rest, triangles));
  Points grafted = rest;
  for (Index v = one.size(); v < static_cast<Index>(rest.rows()); ++v) grafted(v, 0) += 0.3 * std::sin(5.0 * v);
  const ShapeReport report = measure_shape(rest, grafted, triangles, {}, component);
  EXPECT_GT(report.distance_rel, 0.01);            // of the smaller component
  EXPECT_NEAR(report.similarity.scale, 1, 1e-12);  // of the larger one
  EXPECT_LT(report.similarity.translation.norm(), 1e-12);
}

}  // namespace
}  // namespace meshgraft
