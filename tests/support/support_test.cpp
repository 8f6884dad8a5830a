// Checks that generated meshes are as their names say, and that the reference is consistent.
#include <map>
#include <set>

#include <gtest/gtest.h>

#include "operators/intrinsic_delaunay.h"
#include "support/mesh_families.h"
#include "support/oracle.h"

namespace meshgraft::test {
namespace {

int euler_characteristic(const TestMesh& mesh) {
  std::set<Index> vertices;
  std::set<std::pair<Index, Index>> edges;
  for (const auto& t : mesh.triangles.rowwise())
    for (int c = 0; c < 3; ++c) {
      vertices.insert(t[c]);
      edges.insert(std::minmax(t[c], t[(c + 1) % 3]));
    }
  return static_cast<int>(vertices.size()) - static_cast<int>(edges.size()) +
         static_cast<int>(mesh.triangles.rows());
}

int boundary_edges(const TestMesh& mesh) {
  std::map<std::pair<Index, Index>, int> uses;
  for (const auto& t : mesh.triangles.rowwise())
    for (int c = 0; c < 3; ++c) ++uses[std::minmax(t[c], t[(c + 1) % 3])];
  int count = 0;
  for (const auto& [edge, n] : uses) count += n == 1 ? 1 : 0;
  return count;
}

double signed_volume(const TestMesh& mesh) {
  double six = 0;
  for (const auto& t : mesh.triangles.rowwise()) {
    const Eigen::Vector3d a = mesh.positions.row(t[0]), b = mesh.positions.row(t[1]),
                          c = mesh.positions.row(t[2]);
    six += a.dot(b.cross(c));
  }
  return six / 6;
}

TEST(MeshFamilies, EveryMeshIsConsistentlyWoundAndHasArea) {
  for (const TestMesh& mesh : mesh_families()) {
    SCOPED_TRACE(mesh.name);
    std::set<std::pair<Index, Index>> half_edges;
    for (const auto& t : mesh.triangles.rowwise())
      for (int c = 0; c < 3; ++c) EXPECT_TRUE(half_edges.insert({t[c], t[(c + 1) % 3]}).second);
    for (const auto& t : mesh.triangles.rowwise()) {
      const Eigen::RowVector3d u = mesh.positions.row(t[1]) - mesh.positions.row(t[0]),
                               v = mesh.positions.row(t[2]) - mesh.positions.row(t[0]);
      EXPECT_GT(u.cross(v).norm(), 1e-4 * u.norm() * v.norm());
    }
  }
}

TEST(MeshFamilies, GenusAndBordersAreAsNamed) {
  EXPECT_EQ(euler_characteristic(icosphere(2)), 2);
  EXPECT_EQ(euler_characteristic(bar(3, 14)), 2);
  EXPECT_EQ(euler_characteristic(torus(14, 30)), 0);
  EXPECT_EQ(euler_characteristic(plate_with_holes(2, 1)), -2);
  EXPECT_EQ(euler_characteristic(tube(14, 30)), 0);
  EXPECT_EQ(euler_characteristic(irregular_grid(9, 9)), 1);
  for (const TestMesh& mesh :
       {icosphere(2), bar(3, 14), torus(14, 30), plate_with_holes(2, 1), fan_pole(24, 4)}) {
    SCOPED_TRACE(mesh.name);
    EXPECT_EQ(boundary_edges(mesh), 0);
    EXPECT_GT(signed_volume(mesh), 0);
  }
}

TEST(MeshFamilies, RowMeshesConform) {
  for (const RowShape shape : {RowShape::bar, RowShape::tube, RowShape::plane})
    for (const int ratio : {1, 2, 4}) {
      const RowMesh rows = graded_rows(shape, 20, ratio);
      SCOPED_TRACE(rows.mesh.name);
      EXPECT_EQ(euler_characteristic(rows.mesh), shape == RowShape::plane ? 1 : 0);
      EXPECT_NEAR(rows.rows.back().u, rows.length, 1e-12);
      EXPECT_EQ(rows.rows.back().cells, ratio * rows.rows.front().cells);
    }
}

TEST(MeshFamilies, ScenesHaveTwoEnds) {
  for (const TestMesh& mesh : mesh_families()) {
    SCOPED_TRACE(mesh.name);
    const Scene scene = make_scene(mesh);
    EXPECT_FALSE(scene.foot.empty());
    EXPECT_FALSE(scene.head.empty());
    std::set<Index> both(scene.foot.begin(), scene.foot.end());
    both.insert(scene.head.begin(), scene.head.end());
    EXPECT_EQ(both.size(), scene.foot.size() + scene.head.size());
    EXPECT_LT(static_cast<Index>(both.size()), mesh.size());
  }
}

OracleProblem problem_of(const Scene& scene, const Eigen::Affine3d& foot, const Eigen::Affine3d& head) {
  OracleProblem problem;
  problem.rest = scene.mesh.positions;
  problem.triangles = scene.mesh.triangles;
  for (const auto& [vertices, map] : {std::pair{&scene.foot, &foot}, std::pair{&scene.head, &head}})
    for (Index v : *vertices)
      problem.constraints.push_back({v, *map * Eigen::Vector3d(scene.mesh.positions.row(v)), map->linear()});
  return problem;
}

Eigen::Affine3d shear() {
  Eigen::Affine3d map;
  map.linear() << 1.3, 0.25, -0.1, -0.15, 0.8, 0.3, 0.1, 0.05, 1.1;
  map.translation() << 0.4, -0.2, 0.3;
  return map;
}

Eigen::Affine3d turn() {
  return Eigen::Translation3d(0.2, 0.1, 0.4) *
         Eigen::Affine3d(Eigen::AngleAxisd(0.7, Eigen::Vector3d(1, 2, -1).normalized()));
}

template <typename Check>
void for_each_problem(const Eigen::Affine3d& foot, const Eigen::Affine3d& head, Check check) {
  for (const TestMesh& mesh : small_families())
    for (const WeightScheme weights : {WeightScheme::uniform, WeightScheme::cotangent})
      for (const Density density : {Density::ft05, Density::aware}) {
        SCOPED_TRACE(mesh.name + (weights == WeightScheme::uniform ? ", uniform" : ", cotangent") +
                     (density == Density::ft05 ? ", ft05" : ", aware"));
        OracleProblem problem = problem_of(make_scene(mesh), foot, head);
        problem.weights = weights;
        problem.density = density;
        problem.apex = true;
        for (const auto& [ends, weight] : intrinsic_delaunay_edges(mesh.positions, mesh.triangles).edges)
          problem.edges.push_back({ends[0], ends[1], weight});
        check(mesh, problem);
      }
}

TEST(Oracle, AffineImagesHaveNoEnergy) {
  for_each_problem(shear(), shear(), [](const TestMesh& mesh, const OracleProblem& problem) {
    const Oracle oracle(problem);
    const Points image = transformed(mesh, shear(), "").positions;
    EXPECT_LT(oracle.energy(image), 1e-20);
    EXPECT_GT(oracle.energy(mesh.positions), 1e-4);
  });
}

TEST(Oracle, JacobianIsTheDifferenceOfTheRows) {
  for_each_problem(Eigen::Affine3d::Identity(), turn(), [](const TestMesh& mesh, const OracleProblem& problem) {
    const Oracle oracle(problem);
    const auto free = oracle.free_vertices();
    const auto k = static_cast<Eigen::Index>(free.size());
    Points x = mesh.positions, a = oracle.best_apexes(x), step = Points::Random(k, 3), y = x;
    for (Eigen::Index i = 0; i < k; ++i) y.row(free[static_cast<std::size_t>(i)]) += step.row(i);
    const Eigen::MatrixXd difference = oracle.residuals(y, a) - oracle.residuals(x, a);
    const Eigen::MatrixXd predicted = oracle.jacobian().leftCols(k) * step;
    EXPECT_LT((difference - predicted).norm(), 1e-11 * difference.norm());
  });
}

TEST(Oracle, TheDenseMinimumIsOne) {
  for_each_problem(Eigen::Affine3d::Identity(), turn(), [](const TestMesh&, const OracleProblem& problem) {
    const Oracle oracle(problem);
    const Points x = oracle.dense_minimum();
    EXPECT_LT(oracle.relative_gradient(x), 1e-10);
    const double least = oracle.energy(x);
    EXPECT_GT(least, 1e-4);
    Points y = x;
    for (Index i : oracle.free_vertices()) y.row(i) += 1e-3 * Eigen::RowVector3d::Random();
    EXPECT_GT(oracle.energy(y), least);
    EXPECT_GT(oracle.relative_gradient(y), 1e-6);
  });
}

}  // namespace
}  // namespace meshgraft::test
