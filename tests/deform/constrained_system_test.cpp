#include "deform/solve/constrained_system.h"

#include <algorithm>
#include <functional>
#include <string>
#include <utility>
#include <vector>

#include <gtest/gtest.h>
#include <Eigen/Geometry>

#include "deform/system_scene.h"
#include "linalg/sparse.h"
#include "support/mesh_families.h"
#include "support/scene_edits.h"
#include "support/variants.h"

namespace meshgraft {
namespace {

using test::any_columns;
using test::SystemScene;

/// Returns the vertices of faces outside both handles, every `step`-th of them.
std::vector<Index> some_between(const test::Scene& scene, std::size_t step) {
  std::vector<Index> used(scene.mesh.triangles.data(),
                          scene.mesh.triangles.data() + scene.mesh.triangles.size());
  std::sort(used.begin(), used.end());
  used.erase(std::unique(used.begin(), used.end()), used.end());
  std::erase_if(used, [&](Index v) {
    return std::binary_search(scene.foot.begin(), scene.foot.end(), v) ||
           std::binary_search(scene.head.begin(), scene.head.end(), v);
  });
  std::vector<Index> some;
  for (std::size_t k = 0; k < used.size(); k += step) some.push_back(used[k]);
  return some;
}

/// Systems over every small family: with and without stiffness, for both treatments of flat rings, with
/// handles that give only a part of the constraints, and with anchors.
void for_each_system(const std::function<void(const SystemScene&)>& body) {
  for (const test::TestMesh& mesh : test::small_families()) {
    const test::Scene scene = test::make_scene(mesh);
    Region part = test::two_handles(scene), anchored = test::held_foot(scene);
    part.handles[0].constrain_transform = false;
    for (const Index v : some_between(scene, 7)) anchored.anchors.push_back({.vertex = v, .weight = 3});
    const DeformerOptions linear = test::linear_method({.density = Density::ft05});
    const DeformerOptions noisy{.operators = {.degenerate = DegenerateTreatment::ft05_noise}};
    const std::pair<const char*, SystemScene> systems[] = {
        {"stiff", SystemScene(mesh, test::two_handles(scene))},
        {"partly given, linear", SystemScene(mesh, part, linear)},
        {"anchored, with noise", SystemScene(mesh, anchored, noisy)}};
    for (const auto& [name, system] : systems) {
      SCOPED_TRACE(mesh.name + ", " + name);
      body(system);
    }
  }
}

ConstrainedSystem::Known any_values(const SystemScene& scene, unsigned seed) {
  std::vector<VertexConstraint> constraints = scene.all_moved(Eigen::Affine3d::Identity());
  const Columns numbers = any_columns(4 * static_cast<Eigen::Index>(constraints.size()), 3, seed);
  Eigen::Index row = 0;
  for (VertexConstraint& constraint : constraints) {
    if (constraint.position)
      *constraint.position += 0.2 * scene.mesh.box_diagonal() * numbers.row(row).transpose();
    if (constraint.transform) *constraint.transform += 0.4 * numbers.middleRows<3>(row + 1);
    row += 4;
  }
  return scene.system->known_values(constraints);
}

MapField any_field(const SystemScene& scene, unsigned seed) {
  const Index n = scene.system->patch().size();
  return {0.5 * any_columns(3 * n, 3, seed)};
}

/// Checks that two blocks agree relative to the size of the second.
void expect_near(const Columns& a, const Columns& b, double relative) {
  ASSERT_EQ(a.rows(), b.rows());
  ASSERT_EQ(a.cols(), b.cols());
  EXPECT_LE((a - b).norm(), relative * b.norm());
}

/// Returns the nodes of the unknowns in the order of a system's columns: each free vertex, then its apex.
std::vector<Eigen::Index> unknown_nodes(const ConstrainedSystem& system) {
  std::vector<Eigen::Index> nodes;
  for (Index v = 0; v < system.patch().size(); ++v) {
    if (!system.mask().position[v]) nodes.push_back(v);
    const Index apex = system.operators()->nodes().apex[v];
    if (apex >= 0 && system.mask().is_fitted(v)) nodes.push_back(apex);
  }
  return nodes;
}

TEST(ConstrainedSystem, RespondsAsItSolvesWithoutTargets) {
  for_each_system([](const SystemScene& scene) {
    const ConstrainedSystem::Known values = any_values(scene, 1);
    const MapField field = any_field(scene, 2);
    for (const int corrections : {0, 1})
      EXPECT_EQ(scene.system->respond(values, field, corrections, {}),
                scene.system->solve(values, field, {.corrections = corrections}, {}));
  });
}

TEST(ConstrainedSystem, TargetsAddWhatTheyCauseAtRest) {
  for (const test::TestMesh& mesh : test::small_families()) {
    SCOPED_TRACE(mesh.name);
    const test::Scene scene = test::make_scene(mesh);
    Region region = test::held_foot(scene);
    for (const Index v : some_between(scene, 5))
      region.anchors.push_back({.vertex = v,
                                .weight = 1e3,
                                .target = Eigen::Vector3d(0.3, -0.1, 0.2) + mesh.positions.row(v).transpose()});
    const SystemScene anchored(mesh, region);
    const ConstrainedSystem& system = *anchored.system;
    const ConstrainedSystem::Known values = any_values(anchored, 3);
    const MapField field = any_field(anchored, 4);
    const Columns with_targets = system.solve(values, field, {.corrections = 1}, {});
    const Columns targets = system.solve(system.no_values(3), {}, {.corrections = 1}, {});
    EXPECT_GT(targets.norm(), 0.01);
    expect_near(with_targets, system.respond(values, field, 1, {}) + targets, 1e-9);
  }
}

TEST(ConstrainedSystem, CouplingIsTheSquareOfTheRowsOfSmoothness) {
  for_each_system([](const SystemScene& scene) {
    const SparseRows P = scene.system->operators()->P();
    const SparseRows coupling = scene.system->coupling({});
    const SparseRows square = multiply(transpose(P), P);
    EXPECT_GT(square.norm(), 0);
    EXPECT_LE((coupling - square).norm(), 1e-14 * square.norm());
  });
}

TEST(ConstrainedSystem, ResponsesToSeveralCausesAddUp) {
  for_each_system([](const SystemScene& scene) {
    ASSERT_TRUE(scene.system->is_linear());
    const ConstrainedSystem::Known a = any_values(scene, 7), b = any_values(scene, 8);
    const MapField f = any_field(scene, 9), g = any_field(scene, 11);
    const Columns sum =
        scene.system->respond({2 * a.x - 0.5 * b.x, 2 * a.m - 0.5 * b.m}, {2 * f.maps - 0.5 * g.maps}, 1, {});
    expect_near(sum, 2 * scene.system->respond(a, f, 1, {}) - 0.5 * scene.system->respond(b, g, 1, {}), 1e-9);
    // Neither part is without effect, so that the sum is none of one term.
    EXPECT_GT(scene.system->respond(a, {}, 1, {}).norm(), 1e-3);
    EXPECT_GT(scene.system->respond(scene.system->no_values(3), f, 1, {}).norm(), 1e-3);
  });
}

TEST(ConstrainedSystem, FieldRowsGiveTheResponseToAFieldOfNumbers) {
  for_each_system([](const SystemScene& scene) {
    const ConstrainedSystem& system = *scene.system;
    const Index n = system.patch().size();
    const AlikeRows sides = system.field_rows({});
    const Columns phi = any_columns(n, 2, 13);
    for (int axis = 0; axis < 3; ++axis) {
      MapField field{Columns::Zero(3 * n, 2)};
      for (Index v = 0; v < n; ++v) field.maps.row(3 * v + axis) = phi.row(v);
      Columns y = multiply(sides[axis], phi);
      system.back_substitute(y, {});
      expect_near(y, system.respond(system.no_values(2), field, 1, {}), 1e-8);
    }
  });
}

TEST(ConstrainedSystem, SparseRowsGiveDisplacementsAndMapsOfUnknowns) {
  for_each_system([](const SystemScene& scene) {
    const ConstrainedSystem& system = *scene.system;
    const Columns y = any_columns(system.displacement_rows().cols(), 3, 17);
    const ConstrainedSystem::Known none = system.no_values(3);
    const Columns x = system.displacements(y, none, {}), rows = multiply(system.displacement_rows(), y);
    const std::vector<Index>& free = system.free_vertices();
    ASSERT_EQ(rows.rows(), static_cast<Eigen::Index>(free.size()));
    for (std::size_t k = 0; k < free.size(); ++k)
      EXPECT_LT((rows.row(static_cast<Eigen::Index>(k)) - x.row(system.patch().local(free[k]))).norm(), 1e-12);
    EXPECT_EQ(multiply(system.map_rows(), y), system.maps(y, none, {}));
  });
}

TEST(ConstrainedSystem, NothingKnownAndNoFieldGiveExactlyZero) {
  for_each_system([](const SystemScene& scene) {
    const ConstrainedSystem& system = *scene.system;
    const std::vector<VertexConstraint> at_rest = scene.all_moved(Eigen::Affine3d::Identity());
    const ConstrainedSystem::Known values = system.known_values(at_rest);
    EXPECT_TRUE(values.x.isZero(0) && values.m.isZero(0));
    const Columns y = system.respond(values, {}, 1, {});
    EXPECT_TRUE(y.isZero(0));
    EXPECT_TRUE(system.maps(y, values, {}).isZero(0));
    Points positions(scene.mesh.size(), 3);
    EvaluationReport report;
    system.evaluate(at_rest, {}, positions, &report, nullptr, {});
    EXPECT_TRUE(test::same_bytes(positions, scene.mesh.positions));
    EXPECT_EQ(report.residual, 0);
    EXPECT_EQ(report.inverted_maps, 0);
  });
}

TEST(ConstrainedSystem, FollowsAnAffineMapOfAllConstraintsAndOfTheField) {
  int systems = 0;
  for (const test::TestMesh& mesh : test::small_families()) {
    ++systems;  // so that each map meets both treatments
    for (const auto& [name, linear] : test::linear_maps()) {
      SCOPED_TRACE(mesh.name + ", " + name);
      const Eigen::Affine3d map = test::about_middle(mesh, linear);
      const Points expected = test::image(mesh.positions, map);
      const test::Scene scene = test::make_scene(mesh);
      Region region = test::two_handles(scene);
      for (const Index v : some_between(scene, 6))
        region.anchors.push_back({.vertex = v, .weight = 2, .target = expected.row(v).transpose()});
      DeformerOptions options;
      if (++systems % 2 == 0) options.operators.degenerate = DegenerateTreatment::ft05_noise;
      const SystemScene moved(mesh, region, options);
      const ConstrainedSystem& system = *moved.system;
      const Columns maps = test::constant_maps(system.patch().size(), linear);
      Points positions(mesh.size(), 3);
      EvaluationReport report;
      Columns solved;
      system.evaluate(moved.all_moved(map), {{maps}, {}}, positions, &report, &solved, {});
      for (const Index v : system.free_vertices())
        EXPECT_LT((positions.row(v) - expected.row(v)).norm(), 1e-10 * mesh.box_diagonal());
      EXPECT_LT((solved - maps).cwiseAbs().maxCoeff(), 1e-8);
      EXPECT_LT(report.max_transform_deviation, 1e-8);
      EXPECT_EQ(report.inverted_maps > 0, linear.determinant() < 0);
    }
  }
}

TEST(ConstrainedSystem, NormalMatrixIsTheSquareOfTheOperatorsColumns) {
  for (const test::TestMesh& mesh : test::small_families())
    for (const DegenerateTreatment treatment : {DegenerateTreatment::apex, DegenerateTreatment::ft05_noise}) {
      SCOPED_TRACE(mesh.name);
      const SystemScene scene(mesh, test::held_foot(test::make_scene(mesh)),
                              test::linear_method({.degenerate = treatment}));
      const Eigen::MatrixXd A =
          Eigen::MatrixXd(scene.system->operators()->A())(Eigen::all, unknown_nodes(*scene.system));
      const NormalMatrix N = scene.system->normal_matrix({});
      Eigen::MatrixXd lower = Eigen::MatrixXd::Zero(A.cols(), A.cols());
      lower.selfadjointView<Eigen::Lower>().rankUpdate(A.transpose());
      ASSERT_EQ(N.rows(), lower.rows());
      EXPECT_LE((Eigen::MatrixXd(N) - lower).norm(), 1e-12 * lower.norm());
    }
}

TEST(ConstrainedSystem, BackSubstitutionSolvesTheNormalMatrix) {
  for_each_system([](const SystemScene& scene) {
    const NormalMatrix N = scene.system->normal_matrix({});
    const Columns expected = any_columns(N.rows(), 3, 19);
    Columns sides = N.selfadjointView<Eigen::Lower>() * Eigen::MatrixXd(expected);
    scene.system->back_substitute(sides, {});
    expect_near(sides, expected, 1e-7);
  });
}

TEST(ConstrainedSystem, TheSolutionHasTheLeastEnergy) {
  for (const test::TestMesh& mesh : test::small_families())
    for (const DegenerateTreatment treatment : {DegenerateTreatment::apex, DegenerateTreatment::ft05_noise}) {
      SCOPED_TRACE(mesh.name);
      const SystemScene scene(mesh, test::held_foot(test::make_scene(mesh)),
                              test::linear_method({.degenerate = treatment}));
      const ConstrainedSystem& system = *scene.system;
      const AffineOperator& op = *system.operators();
      const ConstrainedSystem::Known values = any_values(scene, 23);
      const MapField field = any_field(scene, 29);
      const Columns fitted = FittedField(op, op.H(), system.mask())(field.maps, {});
      const std::vector<Eigen::Index> nodes = unknown_nodes(system);
      const Columns y = system.solve(values, field, {.corrections = 1}, {});
      const auto rows = [&](const Columns& unknowns) {
        Columns x = values.x;
        for (std::size_t k = 0; k < nodes.size(); ++k)
          x.row(nodes[k]) += unknowns.row(static_cast<Eigen::Index>(k));
        const Columns m = system.maps(unknowns, values, {});
        const Columns laplacian = multiply(op.L(), x) - multiply(op.delta(), m);
        const Columns smoothness = multiply(op.P(), Columns(m - fitted));
        Columns all(laplacian.rows() + smoothness.rows(), 3);
        all << laplacian, smoothness;
        return all;
      };
      const Eigen::MatrixXd A = Eigen::MatrixXd(op.A())(Eigen::all, nodes);
      const Columns least = rows(y);
      const Columns gradient = A.transpose() * least;
      const Columns terms = A.cwiseAbs().transpose() * least.cwiseAbs();
      EXPECT_LE(gradient.norm(), 1e-10 * terms.norm());
      for (unsigned seed = 31; seed < 34; ++seed)
        EXPECT_GT(rows(y + 0.01 * any_columns(y.rows(), 3, seed)).norm(), least.norm());
    }
}

TEST(ConstrainedSystem, TheSolutionDoesNotDependOnTheGuess) {
  for_each_system([](const SystemScene& scene) {
    const ConstrainedSystem& system = *scene.system;
    const ConstrainedSystem::Known values = any_values(scene, 43);
    const MapField field = any_field(scene, 47);
    const Columns alone = system.solve(values, field, {.corrections = 1}, {});
    const Columns error = any_columns(alone.rows(), 3, 53);
    for (const double size : {0.0, 1e-5, 1.0}) {
      const Columns guess = alone + size * alone.norm() / error.norm() * error;
      expect_near(system.solve(values, field, {.corrections = 1, .guess = &guess}, {}), alone, 1e-9);
    }
  });
}

TEST(ConstrainedSystem, SharedPartsGiveTheSolutionOfASystemSetUpAlone) {
  int reused = 0;
  DeformerOptions options;
  double other_stiffness = 0;
  for (const test::TestMesh& mesh : test::small_families()) {
    SCOPED_TRACE(mesh.name);
    std::swap(options.stiffness, other_stiffness);  // every second family has rows on its edges
    const test::Scene scene = test::make_scene(mesh);
    const Region region = test::held_foot(scene);
    const std::vector<Index> between = some_between(scene, 1);
    if (between.size() < 2) continue;
    Region more = region;
    more.handles.push_back(test::make_handle("middle", {between[between.size() / 2]}));
    const SystemScene whole(mesh, region, options), shared(mesh, more, options, &whole),
        alone(mesh, more, options);
    reused += shared.summary.reused;
    EXPECT_FALSE(alone.summary.reused);
    const std::vector<VertexConstraint> constraints = shared.constraints(std::vector{
        test::pose_of(test::head_move(scene)), test::pose_of(Eigen::Affine3d(Eigen::Translation3d(
                                                   0.1 * mesh.box_diagonal() * Eigen::Vector3d::Ones())))});
    Points a(scene.mesh.size(), 3), b(scene.mesh.size(), 3);
    shared.system->evaluate(constraints, {}, a, nullptr, nullptr, {});
    alone.system->evaluate(constraints, {}, b, nullptr, nullptr, {});
    const double bound = std::max(1e-9 * mesh.box_diagonal(), test::eight_ulp(mesh.positions));
    EXPECT_LE(test::largest_distance(a, b), bound);
    // A shared operator has no unknown that was known before.
    const SystemScene fewer(mesh, region, options, &alone);
    EXPECT_FALSE(fewer.summary.reused);
  }
  EXPECT_GT(reused, 6);
}

TEST(ConstrainedSystem, FeaturesTakeTheMapOfTheConstraints) {
  const Eigen::Matrix3d turn = Eigen::AngleAxisd(0.7, Eigen::Vector3d(2, -1, 1).normalized()).matrix();
  for (const test::TestMesh& mesh : test::small_families())
    for (const bool similarity : {false, true}) {
      SCOPED_TRACE(mesh.name);
      const test::Scene scene = test::make_scene(mesh);
      Region region = test::two_handles(scene);
      std::vector<Index> between = some_between(scene, 1);
      if (between.size() < 20) continue;
      between.resize(between.size() / 3);
      region.features = {{.vertices = between, .similarity = similarity}};
      const SystemScene with_feature(mesh, region);
      const ConstrainedSystem& system = *with_feature.system;
      EXPECT_EQ(system.is_linear(), !similarity);
      const Eigen::Affine3d map = test::about_middle(mesh, 1.4 * turn);
      const Columns maps = test::constant_maps(system.patch().size(), map.linear());
      const ConstrainedSystem::Known values = system.known_values(with_feature.all_moved(map));
      const Columns y = system.solve(values, {maps}, {.corrections = 1}, {});
      EXPECT_LT((system.feature_maps(y)[0] - map.linear()).norm(), 1e-7);
      const Columns rows = system.feature_rows(0, y), x = system.displacements(y, values, {});
      for (const Index v : between) {
        const Index local = system.patch().local(v);
        if (local < 0) continue;
        const Eigen::RowVector3d p = system.patch().points.row(local);
        EXPECT_LT((p * rows.topRows<3>() + rows.row(3) - x.row(local)).norm(), 1e-12);
      }
    }
}

TEST(ConstrainedSystem, WithoutUnknownsPlacesTheConstraints) {
  const test::TestMesh mesh = test::grid(4, 3);
  std::vector<Index> all;
  for (Index v = 0; v < mesh.size(); ++v) all.push_back(v);
  Region region;
  region.whole = true;
  region.handles = {test::make_handle("all", all)};
  const SystemScene scene(mesh, region);
  EXPECT_EQ(scene.system->row_count(), 0);
  EXPECT_EQ(scene.system->operators(), nullptr);
  const Eigen::Affine3d map = test::about_middle(mesh, test::linear_maps().front().second);
  Points positions(mesh.size(), 3);
  Columns solved = Columns::Ones(3, 3);
  scene.system->evaluate(scene.all_moved(map), {}, positions, nullptr, &solved, {});
  EXPECT_EQ(solved.rows(), 0);
  EXPECT_LT(test::largest_distance(positions, test::image(mesh.positions, map)), 1e-14);
}

}  // namespace
}  // namespace meshgraft
