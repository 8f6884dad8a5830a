// Laws of the published methods, over families of meshes.
#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>
#include <vector>

#include <gtest/gtest.h>
#include <Eigen/Geometry>

#include <meshgraft/core/error.h>
#include <meshgraft/deform/quality.h>

#include "baselines/baselines.h"
#include "baselines/methods.h"
#include "support/mesh_families.h"
#include "support/scene_edits.h"

namespace meshgraft::test {
namespace {

using Eigen::Affine3d;
using Eigen::AngleAxisd;
using Eigen::Matrix3d;
using Eigen::Vector3d;

/// Returns scenes that are closed, bordered, of genus 1, flat or tiny, with sharp edges or isolated vertices.
std::vector<Scene> scenes() {
  std::vector<Scene> list;
  for (const TestMesh& mesh : {bumpy_sphere(2), irregular_grid(12, 9), torus(14, 9), flat_sheet(9, 7),
                               bar(3, 12), with_isolated_vertices(tube(10, 14)), minute(bumpy_sphere(2))})
    list.push_back(make_scene(mesh));
  return list;
}

void constrain(const Points& rest, const std::vector<Index>& vertices, const Affine3d& map,
               std::vector<VertexConstraint>& constraints) {
  for (Index v : vertices) constraints.push_back({v, map * Vector3d(rest.row(v)), map.linear()});
}

/// Returns constraints that move each end by its own map.
std::vector<VertexConstraint> ends(const Scene& scene, const Affine3d& foot, const Affine3d& head) {
  std::vector<VertexConstraint> constraints;
  constrain(scene.mesh.positions, scene.foot, foot, constraints);
  constrain(scene.mesh.positions, scene.head, head, constraints);
  return constraints;
}

std::vector<std::uint8_t> on_faces(const TestMesh& mesh) {
  std::vector<std::uint8_t> used(static_cast<std::size_t>(mesh.size()), 0);
  for (Index v : mesh.triangles.reshaped()) used[v] = 1;
  return used;
}

/// Returns the largest distance of the surface's vertices from their images under `map`, relative to the box.
double miss(const TestMesh& mesh, const Points& edited, const Affine3d& map) {
  const std::vector<std::uint8_t> used = on_faces(mesh);
  double largest = 0;
  for (Index v = 0; v < mesh.size(); ++v)
    if (used[v])
      largest = std::max(largest, (map * Vector3d(mesh.positions.row(v)) - Vector3d(edited.row(v))).norm());
  return largest / mesh.box_diagonal();
}

/// Moves all constraints by one map and returns how far the surface is from its image.
double miss(const Scene& scene, Baseline method, const Affine3d& map, const BaselineOptions& options = {}) {
  const Points edited = deform_by(
      method, {scene.mesh.positions, scene.mesh.triangles, {.whole = true}, ends(scene, map, map)}, options);
  return miss(scene.mesh, edited, map);
}

Affine3d turn_about_middle(const TestMesh& mesh, double angle_deg) {
  return about_middle(mesh,
                      AngleAxisd(angle_deg * std::numbers::pi / 180, Vector3d(1, 2, -1).normalized()).matrix());
}

class EachBaseline : public testing::TestWithParam<Baseline> {};

TEST_P(EachBaseline, ReproducesTranslations) {
  for (const Scene& scene : scenes()) {
    const Affine3d map(Eigen::Translation3d(Vector3d(0.7, -1.3, 2.1) * scene.mesh.box_diagonal()));
    EXPECT_LT(miss(scene, GetParam(), map), 1e-9) << scene.mesh.name;
  }
}

TEST_P(EachBaseline, ChangesNothingWhenNothingMoves) {
  for (const Scene& scene : scenes())
    EXPECT_LT(miss(scene, GetParam(), Affine3d::Identity()), 1e-9) << scene.mesh.name;
}

TEST_P(EachBaseline, HoldsConstraintsAndTheRest) {
  for (const Scene& scene : scenes()) {
    const Points& rest = scene.mesh.positions;
    // The region is all vertices but those of the foot; it includes isolated ones.
    std::vector<Index> region;
    for (Index v = 0; v < scene.mesh.size(); ++v)
      if (!std::binary_search(scene.foot.begin(), scene.foot.end(), v)) region.push_back(v);
    std::vector<VertexConstraint> constraints;
    constrain(rest, scene.head, head_move(scene), constraints);
    const Points edited =
        deform_by(GetParam(), {rest, scene.mesh.triangles, {.vertices = region}, constraints});
    EXPECT_TRUE(edited.allFinite());
    for (Index v : scene.foot) EXPECT_EQ(edited.row(v), rest.row(v));
    for (const VertexConstraint& constraint : constraints)
      EXPECT_EQ(Vector3d(edited.row(constraint.vertex)), *constraint.position);
    const std::vector<std::uint8_t> used = on_faces(scene.mesh);
    for (Index v = 0; v < scene.mesh.size(); ++v)
      if (!used[v]) {
        EXPECT_EQ(edited.row(v), rest.row(v));
      }
    // Constraints that keep the foot at rest give the same edit.
    const Points told = deform_by(
        GetParam(),
        {rest, scene.mesh.triangles, {.whole = true}, ends(scene, Affine3d::Identity(), head_move(scene))});
    EXPECT_LT(largest_distance(edited, told), 1e-6 * scene.mesh.box_diagonal()) << scene.mesh.name;
  }
}

TEST_P(EachBaseline, StaysFiniteOnAllFamilies) {
  for (const TestMesh& mesh : mesh_families()) {
    const Scene scene = make_scene(mesh);
    const auto constraints = ends(scene, Affine3d::Identity(), head_move(scene));
    try {
      EXPECT_TRUE(
          deform_by(GetParam(), {mesh.positions, mesh.triangles, {.whole = true}, constraints}).allFinite())
          << mesh.name;
    } catch (const Error& error) {
      // On the smallest meshes only two positions are known, which this method refuses.
      EXPECT_EQ(GetParam(), Baseline::sorkine_2004) << mesh.name << ": " << error.what();
      EXPECT_EQ(error.code(), ErrorCode::unsolvable);
      EXPECT_LT(mesh.size(), 10) << mesh.name << ": " << error.what();
    }
  }
}

TEST_P(EachBaseline, TreatsComponentsOnTheirOwn) {
  const TestMesh one = bumpy_sphere(2);
  const Scene scene = make_scene(one);
  TestMesh both = one;
  both.positions.conservativeResize(2 * one.size(), 3);
  both.positions.bottomRows(one.size()) = one.positions.rowwise() + Eigen::RowVector3d(0, 0, 3);
  both.triangles.conservativeResize(2 * one.triangles.rows(), 3);
  both.triangles.bottomRows(one.triangles.rows()) = one.triangles.array() + one.size();
  auto constraints = ends(scene, Affine3d::Identity(), head_move(scene));
  const Points alone = deform_by(GetParam(), {one.positions, one.triangles, {.whole = true}, constraints});
  for (const auto* part : {&scene.foot, &scene.head})  // the second component is held at rest
    for (Index v : *part)
      constraints.push_back(
          {v + one.size(), Vector3d(both.positions.row(v + one.size())), Matrix3d::Identity()});
  const Points edited = deform_by(GetParam(), {both.positions, both.triangles, {.whole = true}, constraints});
  EXPECT_LT(largest_distance(edited.bottomRows(one.size()), both.positions.bottomRows(one.size())), 1e-9);
  // The second component changes when iterations stop, and the unit of the distances between groups.
  EXPECT_LT(largest_distance(edited.topRows(one.size()), alone), 1e-2);
}

TEST_P(EachBaseline, RefusesWhatCouldBeAnywhere) {
  const TestMesh mesh = icosphere(1);
  const auto expect = [&](const std::vector<VertexConstraint>& constraints, ErrorCode code,
                          const std::string& id) {
    SCOPED_TRACE(id);
    try {
      deform_by(GetParam(), {mesh.positions, mesh.triangles, {.whole = true}, constraints});
      ADD_FAILURE() << "no error";
    } catch (const Error& error) {
      EXPECT_EQ(error.code(), code);
      EXPECT_EQ(error.id(), id);
    }
  };
  expect({}, ErrorCode::unsolvable, "baselines.free_component_not_held");
  expect({{0, {}, Matrix3d::Identity()}}, ErrorCode::unsolvable,  // a transform fixes no position
         "baselines.free_component_not_held");
  expect({{mesh.size(), Vector3d::Zero(), {}}}, ErrorCode::input, "core.no_such_vertex");
  expect({{0, {}, {}}}, ErrorCode::input, "deform.vertex_constrains_nothing");
  expect({{0, Vector3d::Zero(), {}}, {0, Vector3d::Zero(), {}}}, ErrorCode::input, "deform.vertex_named_twice");
  expect({{0, Vector3d::Constant(std::nan("")), {}}}, ErrorCode::input, "baselines.constraint_not_finite");
}

INSTANTIATE_TEST_SUITE_P(All, EachBaseline, testing::ValuesIn(all_baselines), [](const auto& method) {
  std::string name(to_string(method.param));
  std::replace(name.begin(), name.end(), '-', '_');
  return name;
});

TEST(Baselines, ReproduceARigidMotionWhereTheirTheorySaysSo) {
  for (const Scene& scene : scenes()) {
    SCOPED_TRACE(scene.mesh.name);
    const Affine3d map = turn_about_middle(scene.mesh, 63);
    // With detail size 0 all shape is detail. The base surface is then harmonic and turns with its boundary.
    EXPECT_LT(miss(scene, Baseline::botsch_kobbelt_2004, map, {.detail_size_rel = 0}), 1e-8);
    EXPECT_LT(miss(scene, Baseline::botsch_kobbelt_2004, map), 5e-3);
    EXPECT_LT(miss(scene, Baseline::yu_2004, map), 1e-8);
    EXPECT_LT(miss(scene, Baseline::yu_2004, map, {.propagation = Propagation::harmonic}), 1e-8);
  }
}

TEST(BotschKobbelt, AddsBackAllDetailForEveryBase) {
  for (const Scene& scene : scenes())
    for (const int order : {1, 2, 3})
      for (const double size : {0.0, 10.0}) {
        const BaselineOptions options{.harmonic_order = order, .detail_size_rel = size};
        EXPECT_LT(miss(scene, Baseline::botsch_kobbelt_2004, Affine3d::Identity(), options), 1e-9)
            << scene.mesh.name << ", k = " << order;
      }
}

// The method estimates rotations from a first result without turned detail, so they are inexact. They must
// still bring the surface closer.
TEST(Lipman, TurnsDetailTheRightWay) {
  for (const Scene& scene : {make_scene(bumpy_sphere(3)), make_scene(grid(24, 18))}) {
    const Affine3d map = turn_about_middle(scene.mesh, 40);
    const auto constraints = ends(scene, map, map);
    const auto problem = baselines::make_problem(
        {scene.mesh.positions, scene.mesh.triangles, {.whole = true}, constraints}, 1, {});
    const baselines::NaiveLaplacian naive(problem, WeightScheme::cotangent, SolverBackend::automatic, {});
    const Points positions = naive.solve(naive.delta(), {});
    Points edited = scene.mesh.positions;
    for (Index v = 0; v < problem.size(); ++v)
      edited.row(problem.patch.vertices[v]) = problem.patch.centre + problem.patch.scale * positions.row(v);
    EXPECT_LT(miss(scene, Baseline::lipman_2004, map, {.normal_rings = 2}), 0.7 * miss(scene.mesh, edited, map))
        << scene.mesh.name;
  }
}

// T_i = s I + [h]× contains uniform scales and the linear part of a rotation. The remainder of a rotation by θ,
// and thus the error, is of order θ².
TEST(Sorkine, ReproducesLinearisedSimilarities) {
  Matrix3d linearised;
  linearised << 1.3, -0.4, 0.7, 0.4, 1.3, -0.2, -0.7, 0.2, 1.3;
  for (const WeightScheme weights : {WeightScheme::uniform, WeightScheme::cotangent})
    for (const Scene& scene : scenes()) {
      SCOPED_TRACE(scene.mesh.name);
      const BaselineOptions options{.sorkine_weights = weights};
      EXPECT_LT(miss(scene, Baseline::sorkine_2004, about_middle(scene.mesh, linearised), options), 1e-9);
      EXPECT_LT(
          miss(scene, Baseline::sorkine_2004, about_middle(scene.mesh, 0.4 * Matrix3d::Identity()), options),
          1e-9);
    }
}

TEST(Sorkine, MissesARotationBySecondOrder) {
  const Scene scene = make_scene(bumpy_sphere(3));
  const double at_4 = miss(scene, Baseline::sorkine_2004, turn_about_middle(scene.mesh, 4));
  const double at_2 = miss(scene, Baseline::sorkine_2004, turn_about_middle(scene.mesh, 2));
  EXPECT_GT(at_2, 1e-9);
  EXPECT_NEAR(at_4 / at_2, 4, 0.2);
}

TEST(Baselines, RefuseWhatTheyWouldIgnore) {
  const TestMesh mesh = icosphere(1);
  for (const Region& region : {Region{.whole = true, .handles = {Handle{.name = "tip", .vertices = {0}}}},
                               Region{.whole = true, .anchors = {Anchor{.vertex = 0}}},
                               Region{.whole = true, .features = {Feature{.vertices = {0, 1, 2}}}}}) {
    try {
      deform_by(Baseline::yu_2004, {mesh.positions, mesh.triangles, region});
      ADD_FAILURE() << "no error";
    } catch (const Error& error) {
      EXPECT_EQ(error.id(), "baselines.only_constraints");
    }
  }
}

TEST(Sorkine, RefusesPlacesOnALine) {
  const TestMesh mesh = icosphere(1);
  const std::vector<VertexConstraint> two{{0, Vector3d(mesh.positions.row(0)), {}},
                                          {5, Vector3d(mesh.positions.row(5)), {}}};
  try {
    deform_by(Baseline::sorkine_2004, {mesh.positions, mesh.triangles, {.whole = true}, two});
    FAIL() << "no error";
  } catch (const Error& error) {
    EXPECT_EQ(error.id(), "baselines.known_positions_on_a_line");
  }
}

TEST(Yu, ReproducesSimilarities) {
  for (const Propagation propagation : {Propagation::distance, Propagation::harmonic})
    for (const Scene& scene : scenes()) {
      const Affine3d turn = turn_about_middle(scene.mesh, 110);
      EXPECT_LT(miss(scene, Baseline::yu_2004, about_middle(scene.mesh, 1.7 * turn.linear()),
                     {.propagation = propagation}),
                1e-8)
          << scene.mesh.name;
    }
}

TEST(Yu, TurnsFreeVerticesByTransformsAlone) {
  // A transform on a free vertex changes the result for this method only.
  const Scene scene = make_scene(irregular_grid(12, 9));
  std::vector<VertexConstraint> constraints = ends(scene, Affine3d::Identity(), Affine3d::Identity());
  Index free = 0;
  while (std::any_of(constraints.begin(), constraints.end(),
                     [&](const VertexConstraint& constraint) { return constraint.vertex == free; }))
    ++free;
  constraints.push_back({free, {}, AngleAxisd(1, Vector3d::UnitZ()).matrix()});
  for (const Baseline method : all_baselines) {
    const Points edited =
        deform_by(method, {scene.mesh.positions, scene.mesh.triangles, {.whole = true}, constraints});
    const double moved = miss(scene.mesh, edited, Affine3d::Identity());
    if (method == Baseline::yu_2004) {
      EXPECT_GT(moved, 1e-3);
    } else {
      EXPECT_LT(moved, 1e-9) << to_string(method);
    }
  }
}

/// The methods that alternate between rotations and positions.
struct Alternating {
  const char* name;
  Baseline method;
  BaselineOptions options;
  bool energy_falls = true;
  double approach = 1e-3;  ///< how much of the first error 200 iterations leave at most
};

baselines::ArapResult deform(const Alternating& it, const baselines::EditProblem& problem,
                             const BaselineOptions& options) {
  switch (it.method) {
    case Baseline::sr_arap_2015: return baselines::deform_sr_arap_2015(problem, options, {});
    case Baseline::smooth_arap_2025: return baselines::deform_smooth_arap_2025(problem, options, {});
    default: return baselines::deform_arap_2007(problem, options, {});
  }
}

class EachArap : public testing::TestWithParam<Alternating> {};

TEST_P(EachArap, EnergyNeverRises) {
  for (const Scene& scene : scenes()) {
    const auto problem = baselines::make_problem({scene.mesh.positions,
                                                  scene.mesh.triangles,
                                                  {.whole = true},
                                                  ends(scene, Affine3d::Identity(), head_move(scene))},
                                                 scene.mesh.size(), {});
    const std::vector<double> energies = deform(GetParam(), problem, GetParam().options).energies;
    ASSERT_GT(energies.size(), 3U) << scene.mesh.name;
    EXPECT_LT(energies.back(), energies.front()) << scene.mesh.name;
    if (!GetParam().energy_falls) continue;  // where the rotations are fitted to a part of the energy
    for (std::size_t k = 1; k < energies.size(); ++k)
      EXPECT_LE(energies[k], energies[k - 1] * (1 + 1e-12)) << scene.mesh.name << ", iteration " << k;
  }
}

// The image under a rigid motion is the only minimum with zero energy. The iteration approaches it step by
// step, since its first guess does not turn the detail.
TEST_P(EachArap, ApproachesRigidMotions) {
  for (const Scene& scene : scenes()) {
    const Affine3d map = turn_about_middle(scene.mesh, 63);
    BaselineOptions none = GetParam().options, many = none;
    none.arap_iterations = 0;
    many.arap_iterations = 200;
    many.arap_tolerance = 0;
    const double start = miss(scene, GetParam().method, map, none);
    EXPECT_LE(miss(scene, GetParam().method, map, many), 1e-9 + GetParam().approach * start) << scene.mesh.name;
  }
}

TEST_P(EachArap, ScalesWithTheModel) {
  for (const Scene& scene : scenes()) {
    const double scale = 300;  // no power of two, by which the patch is scaled anyway
    Scene large = scene;
    large.mesh.positions *= scale;
    const auto edited = [&](const Scene& any) {
      return deform_by(GetParam().method,
                       {any.mesh.positions,
                        any.mesh.triangles,
                        {.whole = true},
                        ends(any, Affine3d::Identity(), head_move(any))},
                       GetParam().options);
    };
    EXPECT_LT(largest_distance(edited(large), scale * edited(scene)), 1e-7 * large.mesh.box_diagonal())
        << scene.mesh.name;
  }
}

INSTANTIATE_TEST_SUITE_P(
    All, EachArap,
    testing::Values(Alternating{"Arap", Baseline::arap_2007, {}}, Alternating{"Sr", Baseline::sr_arap_2015, {}},
                    Alternating{"SrStiff", Baseline::sr_arap_2015, {.sr_alpha = 0.1}},
                    Alternating{"SrCotangent", Baseline::sr_arap_2015, {.sr_weights = WeightScheme::cotangent}},
                    Alternating{"Smooth", Baseline::smooth_arap_2025, {}, false},
                    Alternating{"SmoothWithoutLaplacians", Baseline::smooth_arap_2025, {.smoothness = 0}},
                    Alternating{"SmoothFittedToAll",
                                Baseline::smooth_arap_2025,
                                {.smooth_arap_fit = RotationFit::energy},
                                true,
                                0.05}),
    [](const auto& it) { return std::string(it.param.name); });

TEST(SrArap, WithoutBendingIsArap) {
  for (const Scene& scene : scenes()) {
    const auto edited = [&](Baseline method) {
      return deform_by(method,
                       {scene.mesh.positions,
                        scene.mesh.triangles,
                        {.whole = true},
                        ends(scene, Affine3d::Identity(), head_move(scene))},
                       {.arap_iterations = 20, .arap_tolerance = 0, .sr_alpha = 0});
    };
    EXPECT_LT(largest_distance(edited(Baseline::sr_arap_2015), edited(Baseline::arap_2007)),
              1e-9 * scene.mesh.box_diagonal())
        << scene.mesh.name;
  }
}

/// Returns the quality of a tube whose foot rests and whose head is bent by 60°.
Quality bend_tube(Baseline method, const BaselineOptions& options) {
  const Scene scene = make_scene(tube(24, 48));
  const Affine3d bend(about_middle(scene.mesh, AngleAxisd(std::numbers::pi / 3, Vector3d::UnitX()).matrix()));
  const auto constraints = ends(scene, Affine3d::Identity(), bend);
  std::vector<Index> free;
  for (Index v = 0; v < scene.mesh.size(); ++v)
    if (std::none_of(constraints.begin(), constraints.end(),
                     [&](const auto& held) { return held.vertex == v; }))
      free.push_back(v);
  const Points edited =
      deform_by(method, {scene.mesh.positions, scene.mesh.triangles, {.whole = true}, constraints}, options);
  return measure_quality({scene.mesh.positions, edited, scene.mesh.triangles, free});
}

// The reason for both methods: ARAP concentrates a bend in creases.
TEST(SmoothArap, BendsWithoutCreases) {
  const Quality arap = bend_tube(Baseline::arap_2007, {});
  const Quality sr = bend_tube(Baseline::sr_arap_2015, {});
  const Quality smooth = bend_tube(Baseline::smooth_arap_2025, {});
  EXPECT_LT(sr.dihedral_max_deg, 0.7 * arap.dihedral_max_deg);
  EXPECT_LT(smooth.dihedral_max_deg, 0.7 * arap.dihedral_max_deg);
  EXPECT_LT(smooth.rim_jump_max_deg, 0.5 * arap.rim_jump_max_deg);
}

/// Lifts one vertex in the middle of a flat sheet, whose border rests. Returns how far its neighbours stay
/// behind, as a share of the lift.
double lag_behind_lifted_vertex(Baseline method, int cells) {
  const TestMesh sheet = flat_sheet(cells, cells);
  const Eigen::RowVector3d low = sheet.positions.colwise().minCoeff(),
                           high = sheet.positions.colwise().maxCoeff();
  const double lift = 0.1 * sheet.box_diagonal();
  Index middle = 0;
  (sheet.positions.rowwise() - (low + high) / 2).rowwise().norm().minCoeff(&middle);
  std::vector<VertexConstraint> constraints{
      {middle, Vector3d(sheet.positions.row(middle)) + Vector3d(0, 0, lift), {}}};
  for (Index v = 0; v < sheet.size(); ++v) {
    const Eigen::RowVector3d p = sheet.positions.row(v);
    if (std::min((p - low).head<2>().minCoeff(), (high - p).head<2>().minCoeff()) < 0.02 * sheet.box_diagonal())
      constraints.push_back({v, Vector3d(p), {}});
  }
  const Points edited = deform_by(method, {sheet.positions, sheet.triangles, {.whole = true}, constraints},
                                  {.arap_iterations = 400});
  double lag = 0;
  for (const auto& t : sheet.triangles.rowwise())
    if (t[0] == middle || t[1] == middle || t[2] == middle)
      for (const Index v : t) lag = std::max(lag, 1 - (edited(v, 2) - sheet.positions(v, 2)) / lift);
  return lag;
}

// ARAP makes a spike of a single vertex that is moved.
TEST(SmoothArap, LiftsAVertexWithoutASpike) {
  EXPECT_LT(lag_behind_lifted_vertex(Baseline::smooth_arap_2025, 48),
            0.5 * lag_behind_lifted_vertex(Baseline::arap_2007, 48));
}

TEST(Baselines, CheckTheOptionsOfSmoothRotations) {
  const TestMesh mesh = icosphere(1);
  for (const auto& [options, field] : {std::pair{BaselineOptions{.sr_alpha = -1}, "sr_alpha"},
                                       std::pair{BaselineOptions{.smoothness = 1.1}, "smoothness"},
                                       std::pair{BaselineOptions{.smoothness = std::nan("")}, "smoothness"}}) {
    try {
      deform_by(Baseline::arap_2007, {mesh.positions, mesh.triangles, {.whole = true}}, options);
      ADD_FAILURE() << "no error for " << field;
    } catch (const Error& error) {
      EXPECT_EQ(error.location().text(), field);
    }
  }
}

}  // namespace
}  // namespace meshgraft::test
