#include "deform/solve/surface_fields.h"

#include <algorithm>
#include <cmath>
#include <random>
#include <vector>

#include <gtest/gtest.h>
#include <Eigen/Geometry>

#include "deform/solve/group_weights.h"
#include "linalg/sparse.h"
#include "mesh/shapes.h"
#include "operators/laplacian.h"
#include "support/limb_cases.h"
#include "support/mesh_families.h"

namespace meshgraft {
namespace {

/// A family whose foot and head have given values.
struct FieldScene {
  test::TestMesh mesh;
  IndexLists rings;
  Flags given;

  explicit FieldScene(test::TestMesh family) {
    const test::Scene scene = test::make_scene(std::move(family));
    mesh = scene.mesh;
    rings = vertex_rings(mesh.size(), mesh.triangles);
    given.assign(static_cast<std::size_t>(mesh.size()), 0);
    for (const Index v : scene.foot) given[v] = 1;
    for (const Index v : scene.head) given[v] = 1;
  }
  std::shared_ptr<const BendingMatrix> bending() const {
    const IntrinsicEdges edges = intrinsic_delaunay_edges(mesh.positions, mesh.triangles);
    return std::make_shared<BendingMatrix>(FieldSurface{mesh.positions, mesh.triangles, rings, edges, {}},
                                           Context());
  }
  SurfaceFields fields(const SurfaceFieldOptions& options, const Context& context = {}) const {
    const auto bisection = std::make_shared<BisectionTree>();
    const IntrinsicEdges edges = intrinsic_delaunay_edges(mesh.positions, mesh.triangles);
    return {{mesh.positions, mesh.triangles, rings, edges, bisection}, given, bending(), options, context};
  }
  SurfaceFields fields(double smoothing_length_rel = 0.1, const Context& context = {}) const {
    return fields({.smoothing_length_rel = smoothing_length_rel}, context);
  }
  double free_area() const {
    const std::vector<double> areas = vertex_areas(mesh.positions, mesh.triangles);
    double area = 0;
    for (Index v = 0; v < mesh.size(); ++v) area += given[v] ? 0 : areas[v];
    return area;
  }
  Columns values(Eigen::Index columns) const {
    std::mt19937 random(23);
    return Columns::NullaryExpr(mesh.size(), columns,
                                [&] { return static_cast<double>(random()) / 2147483648.0 - 1; });
  }
};

std::vector<FieldScene> field_scenes() {
  std::vector<FieldScene> scenes;
  for (const test::TestMesh& mesh : test::small_families()) scenes.emplace_back(mesh);
  return scenes;
}

TEST(SurfaceFields, SpreadKeepsGivenValuesToTheBit) {
  for (const FieldScene& scene : field_scenes()) {
    const Columns values = scene.values(3), spread = scene.fields().spread(values);
    for (Index v = 0; v < scene.mesh.size(); ++v)
      if (scene.given[v]) {
        EXPECT_EQ(spread.row(v), values.row(v)) << scene.mesh.name;
      }
  }
}

TEST(SurfaceFields, SpreadOfAConstantIsExactlyConstant) {
  for (const FieldScene& scene : field_scenes()) {
    Columns values = scene.values(2);
    for (Index v = 0; v < scene.mesh.size(); ++v)
      if (scene.given[v]) values.row(v) << 0.1, -7;
    const Columns spread = scene.fields().spread(values);
    for (Index v = 0; v < scene.mesh.size(); ++v)
      if (!scene.rings[v].empty()) {
        EXPECT_EQ(spread.row(v), Eigen::RowVector2d(0.1, -7)) << scene.mesh.name;
      }
  }
}

TEST(SurfaceFields, SpreadIsLinear) {
  for (const FieldScene& scene : field_scenes()) {
    const SurfaceFields fields = scene.fields();
    const Columns values = scene.values(2);
    const Columns both = fields.spread(values.col(0) - 3 * values.col(1));
    const Columns each = fields.spread(values);
    EXPECT_LT((both - (each.col(0) - 3 * each.col(1))).cwiseAbs().maxCoeff(),
              1e-7 * (1 + each.cwiseAbs().maxCoeff()))
        << scene.mesh.name;
  }
}

/// Expects that changes of free values raise the energy fᵀ E f of a spread field.
void expect_least(const FieldScene& scene, const SurfaceFields& fields, const SparseRows& E) {
  const Columns spread = fields.spread(scene.values(1));
  const auto energy = [&](const Columns& f) { return f.cwiseProduct(multiply(E, f)).sum(); };
  const double least = energy(spread);
  std::mt19937 random(29);
  for (int k = 0; k < 10; ++k)
    for (const double size : {1e-3, 1.0}) {
      Columns rival = spread;
      for (Index v = 0; v < scene.mesh.size(); ++v)
        if (!scene.given[v]) rival(v, 0) += size * (static_cast<double>(random()) / 2147483648.0 - 1);
      EXPECT_LE(least, energy(rival) * (1 + 1e-9)) << scene.mesh.name;
    }
}

TEST(SurfaceFields, SpreadHasTheLeastBending) {
  for (const FieldScene& scene : field_scenes())
    expect_least(scene, scene.fields({.bending_length_rel = {}}), scene.bending()->matrix);
}

TEST(SurfaceFields, SpreadHasTheLeastTensionAndBending) {
  for (const FieldScene& scene : field_scenes()) {
    const SurfaceFields fields = scene.fields({.bending_length_rel = 0.1});
    if (fields.constrained_components().size() > 1) continue;  // each has a bending length of its own
    const std::shared_ptr<const BendingMatrix> bending = scene.bending();
    expect_least(scene, fields, bending->tension + 0.01 * scene.free_area() * bending->matrix);
  }
}

TEST(SurfaceFields, SpreadIsNearlyLinearAlongAPipe) {
  // A harmonic field on a pipe between two ends is a linear function of the height.
  const test::Limb limb = test::make_limb({.radii = 8});
  FieldScene scene(limb.mesh);
  scene.given.assign(scene.given.size(), 1);
  for (const Index v : limb.middle) scene.given[v] = 0;
  Columns values = Columns::Zero(limb.mesh.size(), 1);
  for (const Index v : limb.top) values(v, 0) = 1;
  const Columns tense = scene.fields().spread(values),
                bent = scene.fields({.bending_length_rel = {}}).spread(values);
  double deviation = 0, cubic = 0;
  for (const Index v : limb.middle) {
    const double height = limb.mesh.positions(v, 2) / limb.length;
    deviation = std::max(deviation, std::abs(tense(v, 0) - height));
    cubic = std::max(cubic, std::abs(bent(v, 0) - height * height * (3 - 2 * height)));
  }
  EXPECT_LT(deviation, 0.03);
  EXPECT_LT(cubic, 0.01);
}

TEST(SurfaceFields, SmoothIsZeroWhereGivenAndMinimisesItsEnergy) {
  for (const FieldScene& scene : field_scenes()) {
    const SurfaceFields fields = scene.fields(1e-9);  // so short that nothing is smoothed
    const Columns values = scene.values(2), start = Columns::Zero(scene.mesh.size(), 2);
    const Columns faithful = fields.smooth(values, start), smooth = scene.fields(0.3).smooth(values, start);
    for (Index v = 0; v < scene.mesh.size(); ++v) {
      if (scene.rings[v].empty()) continue;
      if (scene.given[v]) {
        EXPECT_TRUE(faithful.row(v).isZero(0) && smooth.row(v).isZero(0)) << scene.mesh.name;
      } else {
        EXPECT_LT((faithful.row(v) - values.row(v)).norm(), 1e-6) << scene.mesh.name;
      }
    }
    const SparseRows B = scene.bending()->matrix;
    EXPECT_LT(smooth.cwiseProduct(multiply(B, smooth)).sum(),
              faithful.cwiseProduct(multiply(B, faithful)).sum())
        << scene.mesh.name;
  }
}

TEST(SurfaceFields, DoNotDependOnPoseAndUnit) {
  for (const FieldScene& scene : field_scenes()) {
    Eigen::Affine3d map(Eigen::AngleAxisd(1.2, Eigen::Vector3d(1, -2, 0.5).normalized()));
    map.pretranslate(Eigen::Vector3d(3, -1, 2));
    map.linear() *= 100;
    FieldScene other = scene;
    other.mesh = test::transformed(scene.mesh, map, " posed");
    const Columns values = scene.values(2), start = Columns::Zero(scene.mesh.size(), 2);
    const Columns one = scene.fields().spread(values), two = other.fields().spread(values);
    EXPECT_LT((one - two).norm(), 1e-6 * (1 + one.norm())) << scene.mesh.name;
    const Columns smooth = scene.fields().smooth(values, start), also = other.fields().smooth(values, start);
    EXPECT_LT((smooth - also).norm(), 1e-6 * (1 + smooth.norm())) << scene.mesh.name;
  }
}

TEST(SurfaceFields, TheNumberOfThreadsDoesNotMatter) {
  for (const FieldScene& scene : field_scenes()) {
    const Columns values = scene.values(3), start = Columns::Zero(scene.mesh.size(), 3);
    const Context one = shapes::with_threads(1);
    const SurfaceFields alone = scene.fields(0.1, one);
    for (const int threads : {2, 3}) {
      const Context several = shapes::with_threads(threads);
      const SurfaceFields shared = scene.fields(0.1, several);
      EXPECT_EQ(alone.spread(values, one), shared.spread(values, several)) << scene.mesh.name;
      EXPECT_EQ(alone.smooth(values, start, one), shared.smooth(values, start, several)) << scene.mesh.name;
    }
  }
}

TEST(SurfaceFields, ComponentsWithoutGivenValuesKeepTheirs) {
  const test::TestMesh one = test::bumpy_sphere(1);
  const Index n = one.size();
  FieldScene scene(one);
  scene.mesh.positions.resize(2 * n, 3);
  scene.mesh.positions << one.positions, one.positions.array() + 4;
  scene.mesh.triangles.resize(2 * one.triangles.rows(), 3);
  scene.mesh.triangles << one.triangles, one.triangles.array() + n;
  scene.rings = vertex_rings(2 * n, scene.mesh.triangles);
  scene.given.resize(static_cast<std::size_t>(2 * n), 0);
  const SurfaceFields fields = scene.fields();
  EXPECT_EQ(fields.component()[0], 0);
  EXPECT_EQ(fields.component()[n], 1);
  EXPECT_EQ(fields.constrained_components(), (Flags{1, 0}));
  const Columns values = scene.values(2), spread = fields.spread(values);
  EXPECT_EQ(spread.bottomRows(n), values.bottomRows(n));
  EXPECT_NE(spread.topRows(n), values.topRows(n));
}

/// Values that are the same on each group of a scene, and any elsewhere.
Columns values_of_groups(const FieldScene& scene, const GroupWeights& groups) {
  Columns values = scene.values(3);
  std::vector<Index> first(groups.count(), -1);
  for (Index v = 0; v < scene.mesh.size(); ++v) {
    if (groups.group()[v] < 0) continue;
    if (Index& w = first[groups.group()[v]]; w < 0) w = v;
    values.row(v) = values.row(first[groups.group()[v]]);
  }
  return values;
}

TEST(GroupWeights, GiveTheSpreadOfValuesThatAreTheSameOnEachGroup) {
  for (const FieldScene& scene : field_scenes()) {
    SCOPED_TRACE(scene.mesh.name);
    const SurfaceFields fields = scene.fields();
    const GroupWeights groups(scene.rings, scene.given, fields, {});
    ASSERT_EQ(groups.count(), 2);
    const Columns values = values_of_groups(scene, groups);
    const auto common = groups.common_values(values);
    ASSERT_TRUE(common);
    EXPECT_LE((groups.spread(*common, values, {}) - fields.spread(values)).cwiseAbs().maxCoeff(), 1e-8);
  }
}

TEST(GroupWeights, KeepAConstantAndGivenValuesToTheBit) {
  for (const FieldScene& scene : field_scenes()) {
    SCOPED_TRACE(scene.mesh.name);
    const SurfaceFields fields = scene.fields();
    const GroupWeights groups(scene.rings, scene.given, fields, {});
    const Columns constant = Columns::Constant(scene.mesh.size(), 3, 0.3);
    EXPECT_EQ(groups.spread(groups.common_values(constant).value(), constant, {}), constant);
    const Columns values = values_of_groups(scene, groups);
    const Columns spread = groups.spread(groups.common_values(values).value(), values, {});
    for (Index v = 0; v < scene.mesh.size(); ++v)
      if (scene.given[v]) {
        EXPECT_EQ(spread.row(v), values.row(v));
      }
  }
}

TEST(GroupWeights, AreNotUsedWhereValuesDifferWithinAGroup) {
  const FieldScene scene(test::tube(10, 16));
  const GroupWeights groups(scene.rings, scene.given, scene.fields(), {});
  Columns values = values_of_groups(scene, groups);
  EXPECT_TRUE(groups.common_values(values));
  const auto last = std::find(scene.given.rbegin(), scene.given.rend(), 1);
  values(scene.given.rend() - last - 1, 2) += 1e-12;
  EXPECT_FALSE(groups.common_values(values));
}

TEST(GroupWeights, AreNotUsedWhereNothingIsGivenOrManyGroupsShareColumns) {
  FieldScene scene(test::tube(10, 16));
  const Columns values = Columns::Zero(scene.mesh.size(), 3);
  scene.given.assign(scene.given.size(), 0);
  EXPECT_FALSE(GroupWeights(scene.rings, scene.given, scene.fields(), {}).common_values(values));
  FieldScene dotted(test::bumpy_sphere(4));
  dotted.given.assign(dotted.given.size(), 0);
  for (std::size_t v = 0; v < dotted.given.size(); v += 40) dotted.given[v] = 1;
  const GroupWeights many(dotted.rings, dotted.given, dotted.fields(), {});
  ASSERT_GT(many.count(), 16);
  EXPECT_FALSE(many.common_values(Columns::Zero(dotted.mesh.size(), 3)));
}

}  // namespace
}  // namespace meshgraft
