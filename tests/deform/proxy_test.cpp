// A decimated proxy obeys the laws of the direct solve and approximates its results.
#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <stop_token>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include <meshgraft/core/error.h>
#include <meshgraft/deform/quality.h>
#include <meshgraft/deform/quick_frames.h>
#include <meshgraft/mesh/topology.h>

#include "support/defects.h"
#include "support/mesh_families.h"
#include "support/scene_edits.h"
#include "support/variants.h"

namespace meshgraft::test {
namespace {

using Eigen::Affine3d;
using Eigen::Vector3d;

ProxyOptions proxy_of(Index vertices, const DeformerOptions& deformer = {}) {
  ProxyOptions options;
  options.vertices = vertices;
  options.deformer = deformer;
  return options;
}

ProxyDeformer make_proxy(const Scene& scene, const Region& region, Index vertices,
                         const DeformerOptions& deformer = {}) {
  return {scene.mesh.positions, scene.mesh.triangles, region, proxy_of(vertices, deformer)};
}

Points by_proxy(const Scene& scene, Index vertices, const DeformerOptions& deformer = {}) {
  return make_proxy(scene, held_foot(scene), vertices, deformer)
      .evaluate(std::vector{pose_of(head_move(scene))});
}

Points directly(const Scene& scene, const DeformerOptions& deformer = {}) {
  return Deformer(scene.mesh.positions, scene.mesh.triangles, held_foot(scene), deformer)
      .evaluate(std::vector{pose_of(head_move(scene))});
}

/// Returns the root mean square of the distances, relative to the largest displacement.
double difference(const Scene& scene, const Points& result, const Points& reference) {
  const double moved = largest_distance(reference, scene.mesh.positions);
  return std::sqrt((result - reference).rowwise().squaredNorm().mean()) / moved;
}

std::vector<Scene> medium_scenes() {
  std::vector<Scene> scenes;
  for (TestMesh& mesh :
       std::vector<TestMesh>{irregular_grid(66, 44), bar(8, 60), tube(40, 60), bumpy_sphere(4)})
    scenes.push_back(make_scene(std::move(mesh)));
  return scenes;
}

TEST(Proxy, AffineMapsAreReproduced) {
  std::vector<TestMesh> meshes = mesh_families();
  for (const Scene& scene : medium_scenes()) meshes.push_back(scene.mesh);
  for (const TestMesh& mesh : meshes) {
    const Scene scene = make_scene(mesh);
    for (const DegenerateTreatment treatment : {DegenerateTreatment::apex, DegenerateTreatment::ft05_noise}) {
      const ProxyDeformer proxy =
          make_proxy(scene, two_handles(scene), mesh.size() / 6 + 50, linear_method({.degenerate = treatment}));
      for (const auto& [name, linear] : linear_maps()) {
        SCOPED_TRACE(mesh.name + ", " + name + ", " + std::string(to_string(treatment)));
        const Affine3d map = about_middle(mesh, linear);
        const Points result = proxy.evaluate(std::vector{pose_of(map), pose_of(map)});
        const Points expected = image(mesh.positions, map);
        double error = 0;
        for (const Index v : mesh.triangles.reshaped())
          error = std::max(error, (result.row(v) - expected.row(v)).norm());
        EXPECT_LE(error,
                  std::max({1e-9 * mesh.box_diagonal(), eight_ulp(expected), eight_ulp(mesh.positions)}));
      }
    }
  }
}

TEST(Proxy, NothingMovesWhenNothingIsMoved) {
  for (const Scene& scene : medium_scenes()) {
    SCOPED_TRACE(scene.mesh.name);
    EXPECT_TRUE(same_bytes(make_proxy(scene, held_foot(scene), 300).evaluate(std::vector{HandlePose{}}),
                           scene.mesh.positions));
  }
}

TEST(Proxy, WhatIsHeldIsExact) {
  for (const Scene& scene : medium_scenes()) {
    SCOPED_TRACE(scene.mesh.name);
    const Points result = by_proxy(scene, 300);
    const Affine3d move = head_move(scene);
    for (const Index v : scene.foot) EXPECT_EQ(result.row(v), scene.mesh.positions.row(v));
    for (const Index v : scene.head) {
      const Vector3d expected = move * scene.mesh.positions.row(v).transpose();
      EXPECT_EQ(Vector3d(result.row(v).transpose()), expected);
    }
  }
}

TEST(Proxy, ApproachesTheDirectSolve) {
  for (const Scene& scene : medium_scenes())
    for (const DeformMethod method : {DeformMethod::ft05, DeformMethod::corotational}) {
      SCOPED_TRACE(scene.mesh.name + ", " + std::string(to_string(method)));
      const Points reference = directly(scene, {.method = method});
      const double coarse = difference(scene, by_proxy(scene, 150, {.method = method}), reference),
                   medium = difference(scene, by_proxy(scene, 900, {.method = method}), reference),
                   all = difference(scene, by_proxy(scene, scene.mesh.size(), {.method = method}), reference);
      RecordProperty(scene.mesh.name, std::to_string(coarse) + " " + std::to_string(medium));
      EXPECT_LT(medium, 0.045);
      EXPECT_LT(medium, coarse);
      EXPECT_LT(all, 1e-10);
    }
}

// Coarse regions have less stiffness. A coarse proxy of a fine region has as much as the region.
TEST(Proxy, IsAsStiffAsTheRegion) {
  const Scene scene = make_scene(tube(120, 180));
  const std::vector bend{pose_of(Affine3d(Eigen::AngleAxisd(1, Vector3d::UnitY())))};
  const auto solved = [&](const auto& deformer) { return deformer.evaluate(bend); };
  const Points reference =
      solved(Deformer(scene.mesh.positions, scene.mesh.triangles, held_foot(scene), DeformerOptions()));
  EXPECT_LT(difference(scene, solved(make_proxy(scene, held_foot(scene), 1500)), reference), 0.01);
}

TEST(Proxy, DetailIsNeitherCrinkledNorCutOffAtRims) {
  for (const TestMesh& mesh : {bumpy_sphere(5), irregular_grid(100, 80), tube(80, 100)}) {
    SCOPED_TRACE(mesh.name);
    const Scene scene = make_scene(mesh);
    const Points reference = directly(scene);
    const ProxyDeformer proxy = make_proxy(scene, held_foot(scene), mesh.size() / 40);
    const Points result = proxy.evaluate(std::vector{pose_of(head_move(scene))});
    const Quality beside = measure_quality({reference, result, mesh.triangles, proxy.free_vertices()},
                                           {.self_intersections = false});
    const Quality moved = measure_quality({mesh.positions, reference, mesh.triangles, proxy.free_vertices()},
                                          {.self_intersections = false});
    // The bounds are relative to how the edit itself changes the angles. Unless vertices near rims follow the
    // rims, the jumps of the sphere and the sheet are 1.8 and 2.9 times those of the edit.
    EXPECT_LT(beside.dihedral_p99_deg, 2 * moved.dihedral_p99_deg);
    EXPECT_LT(beside.rim_jump_max_deg, 1.1 * moved.rim_jump_max_deg);
  }
}

TEST(Proxy, AsManyVerticesAsAskedFor) {
  for (const Scene& scene : medium_scenes())
    for (const Index asked : {200, 600, 1000}) {
      SCOPED_TRACE(scene.mesh.name + ", " + std::to_string(asked));
      const ProxyDeformer proxy = make_proxy(scene, held_foot(scene), asked);
      Index free = 0;
      const auto all = proxy.free_vertices();
      for (const Index v : proxy.proxy_vertices()) free += std::binary_search(all.begin(), all.end(), v);
      EXPECT_EQ(free, proxy.summary().deformer.free_vertices);
      EXPECT_GT(free, asked / 2);
      EXPECT_LT(free, asked + 100);
      EXPECT_TRUE(std::is_sorted(proxy.proxy_vertices().begin(), proxy.proxy_vertices().end()));
    }
}

TEST(Proxy, KeepsTheTopology) {
  for (const TestMesh& mesh :
       {torus(40, 70), bar(8, 60), tube(40, 60), plate_with_holes(3, 3), bumpy_sphere(4)}) {
    SCOPED_TRACE(mesh.name);
    const Scene scene = make_scene(mesh, 0.05, 0.05);
    const ProxyDeformer proxy = make_proxy(scene, held_foot(scene), mesh.size() / 8);
    Points places(static_cast<Eigen::Index>(proxy.proxy_vertices().size()), 3);
    for (std::size_t k = 0; k < proxy.proxy_vertices().size(); ++k)
      places.row(static_cast<Eigen::Index>(k)) = mesh.positions.row(proxy.proxy_vertices()[k]);
    const TopologySummary coarse = summarise_topology(make_mesh(places, proxy.proxy_triangles())),
                          fine = summarise_topology(make_mesh(mesh.positions, mesh.triangles));
    EXPECT_TRUE(coarse.manifold);
    EXPECT_EQ(coarse.components, fine.components);
    EXPECT_LT(coarse.vertices, fine.vertices / 2);
    if (coarse.boundary_loops == fine.boundary_loops) {
      EXPECT_EQ(coarse.euler_characteristic, fine.euler_characteristic);
    }
  }
}

TEST(Proxy, SameBytesForAnyNumberOfThreads) {
  for (const Scene& scene : medium_scenes()) {
    SCOPED_TRACE(scene.mesh.name);
    std::vector<Points> results;
    for (const int threads : {1, 2, 1}) {
      Context context;
      context.threads = threads;
      const ProxyDeformer proxy(scene.mesh.positions, scene.mesh.triangles, held_foot(scene), proxy_of(400),
                                context);
      results.push_back(proxy.evaluate(std::vector{pose_of(head_move(scene))}, context));
    }
    EXPECT_TRUE(same_bytes(results[0], results[1]));
    EXPECT_TRUE(same_bytes(results[0], results[2]));
  }
}

/// A sheet whose border is fixed, with a handle of one vertex or a curve of them in its middle.
struct Sheet {
  TestMesh mesh = irregular_grid(80, 60);
  Region region;
  explicit Sheet(Handle handle) {
    region.whole = true;
    for (Index v = 0; v < mesh.size(); ++v) {
      const Index column = v % 81, row = v / 81;
      if (column < 2 || column > 78 || row < 2 || row > 58) region.fixed.push_back(v);
    }
    region.handles = {std::move(handle)};
  }
};

TEST(Proxy, SingleVerticesAndCurvesSurvive) {
  Handle vertex = make_handle("vertex", {30 * 81 + 40});
  vertex.shape = HandleShape::vertex;
  Handle curve = make_handle("curve", {});
  curve.shape = HandleShape::curve;
  for (Index column = 25; column <= 55; ++column) curve.vertices.push_back(30 * 81 + column);
  for (const Handle& handle : {vertex, curve}) {
    const Sheet sheet(handle);
    SCOPED_TRACE(handle.name);
    const double size = sheet.mesh.box_diagonal();
    const auto pose = pose_of(Affine3d(Eigen::Translation3d(0, 0, 0.15 * size)));
    const Points reference =
        Deformer(sheet.mesh.positions, sheet.mesh.triangles, sheet.region).evaluate(std::vector{pose});
    const ProxyDeformer proxy(sheet.mesh.positions, sheet.mesh.triangles, sheet.region, proxy_of(1000));
    EXPECT_LT(proxy.summary().vertices, 2000);
    const Points result = proxy.evaluate(std::vector{pose});
    for (const Index v : handle.vertices) EXPECT_EQ(result.row(v), reference.row(v));
    EXPECT_LT(largest_distance(result, reference), 0.1 * 0.15 * size);
  }
}

TEST(Proxy, RedrawnCurvesAreFollowed) {
  Handle curve = make_handle("curve", {});
  curve.shape = HandleShape::curve;
  for (Index column = 25; column <= 55; ++column) curve.vertices.push_back(30 * 81 + column);
  const Sheet sheet(curve);
  HandlePose pose;
  pose.curve = Points(static_cast<Eigen::Index>(curve.vertices.size()), 3);
  for (std::size_t k = 0; k < curve.vertices.size(); ++k) {
    const double t = static_cast<double>(k) / static_cast<double>(curve.vertices.size() - 1);
    pose.curve->row(static_cast<Eigen::Index>(k)) =
        sheet.mesh.positions.row(curve.vertices[k]) +
        0.1 * sheet.mesh.box_diagonal() * Eigen::RowVector3d(0, 0, std::sin(3.14159 * t));
  }
  const Points reference =
      Deformer(sheet.mesh.positions, sheet.mesh.triangles, sheet.region).evaluate(std::vector{pose});
  double last = 1;
  for (const Index vertices : {300, 1200, 4700}) {
    const ProxyDeformer proxy(sheet.mesh.positions, sheet.mesh.triangles, sheet.region, proxy_of(vertices));
    const Points result = proxy.evaluate(std::vector{pose});
    for (const Index v : curve.vertices) EXPECT_EQ(result.row(v), reference.row(v));
    const double off =
        std::sqrt((result - reference).rowwise().squaredNorm().mean()) / (0.1 * sheet.mesh.box_diagonal());
    EXPECT_LT(off, last);
    last = off;
  }
  EXPECT_LT(last, 1e-10);  // the last proxy keeps all vertices
}

TEST(Proxy, PositionsAloneHoldIt) {
  for (const TestMesh& mesh : {bumpy_sphere(4), bar(10, 60), irregular_grid(60, 50)}) {
    SCOPED_TRACE(mesh.name);
    const Scene scene = make_scene(mesh);
    Region region = two_handles(scene);
    for (Handle& handle : region.handles) handle.constrain_transform = false;
    const Affine3d map = about_middle(mesh, linear_maps()[0].second);
    const Points result =
        make_proxy(scene, region, 300, linear_method()).evaluate(std::vector{pose_of(map), pose_of(map)});
    EXPECT_LT(largest_distance(result, image(mesh.positions, map)), 1e-9 * mesh.box_diagonal());
  }
}

TEST(Proxy, ConstraintsPerVertexDoWhatHandlesDo) {
  const Scene scene = make_scene(bumpy_sphere(4));
  const Affine3d move = head_move(scene);
  std::vector<VertexConstraint> constraints;
  std::vector<Index> region(static_cast<std::size_t>(scene.mesh.size()));
  std::iota(region.begin(), region.end(), Index{0});
  std::vector<Index> free;
  std::set_difference(region.begin(), region.end(), scene.foot.begin(), scene.foot.end(),
                      std::back_inserter(free));
  for (const Index v : scene.head)
    constraints.push_back({v, move * scene.mesh.positions.row(v).transpose(), move.linear()});
  const auto options = proxy_of(500);
  const Points one =
      ProxyDeformer({scene.mesh.positions, scene.mesh.triangles, {.vertices = free}, constraints}, options)
          .evaluate(constraints);
  EXPECT_LT(difference(scene, one, by_proxy(scene, 500)), 1e-12);
}

TEST(Proxy, AnchorsPullAlike) {
  const Scene scene = make_scene(irregular_grid(90, 60));
  Region region = held_foot(scene);
  for (Index v = 0; v < scene.mesh.size(); ++v) {
    const double x = scene.mesh.positions(v, 0) / scene.mesh.positions.col(0).maxCoeff();
    if (x > 0.4 && x < 0.6) region.anchors.push_back({v, 1000});
  }
  const std::vector poses{pose_of(head_move(scene))};
  const Points free = directly(scene),
               anchored = Deformer(scene.mesh.positions, scene.mesh.triangles, region).evaluate(poses),
               result = make_proxy(scene, region, 1500).evaluate(poses);
  const double effect = difference(scene, anchored, free);
  EXPECT_GT(effect, 0.02);
  EXPECT_LT(difference(scene, result, anchored), 0.3 * effect);
}

TEST(Proxy, FeaturesKeepTheirShape) {
  const Scene scene = make_scene(irregular_grid(90, 60));
  Region region = held_foot(scene);
  Feature feature;
  for (Index v = 0; v < scene.mesh.size(); ++v) {
    const double x = scene.mesh.positions(v, 0) / scene.mesh.positions.col(0).maxCoeff(),
                 y = scene.mesh.positions(v, 1) / scene.mesh.positions.col(1).maxCoeff();
    if (std::hypot(x - 0.5, y - 0.5) < 0.12) feature.vertices.push_back(v);
  }
  region.features = {feature};
  const std::vector poses{pose_of(head_move(scene))};
  const Points result = make_proxy(scene, region, 1500).evaluate(poses),
               reference = Deformer(scene.mesh.positions, scene.mesh.triangles, region).evaluate(poses);
  EXPECT_LT(fit_affine(scene.mesh.positions, result, feature.vertices).misfit, 1e-9);
  EXPECT_LT(difference(scene, result, reference), 0.03);
}

TEST(Proxy, FarAwayAndMinuteModelsWork) {
  const TestMesh mesh = bumpy_sphere(4);
  const Scene scene = make_scene(mesh), small = make_scene(minute(mesh));
  const Points result = by_proxy(scene, 400), shrunk = by_proxy(small, 400);
  EXPECT_LT(largest_distance(result * 1e-6, shrunk), 1e-6 * 1e-2 * mesh.box_diagonal());
  const Scene far = make_scene(far_away(mesh));
  EXPECT_LT(difference(far, by_proxy(far, 400), directly(far)), 0.05);
}

TEST(Proxy, WorksOnDirtyScansWhereTheDirectSolveDoes) {
  for (const DirtyScan& scan : dirty_scans()) {
    SCOPED_TRACE(scan.name);
    TestMesh mesh{scan.name, scan.mesh.positions, {}};
    try {
      mesh.triangles = triangulate(scan.mesh, {.skip_out_of_range = true}).triangles;
      const Scene scene = make_scene(mesh);
      const Points reference = directly(scene);
      const Points result = by_proxy(scene, 400);
      EXPECT_TRUE(result.allFinite() || !mesh.positions.allFinite());
    } catch (const Error& error) {
      // The proxy refuses what the direct solve refuses, with the same message.
      const Scene scene = make_scene(mesh);
      std::string of_direct, of_proxy;
      try {
        directly(scene);
      } catch (const Error& direct) {
        of_direct = direct.what();
      }
      try {
        by_proxy(scene, 400);
      } catch (const Error& proxy) {
        of_proxy = proxy.what();
      }
      EXPECT_EQ(of_direct, of_proxy);
    }
  }
}

TEST(Proxy, OnlyTheSurroundingsOfTheRegionCount) {
  TestMesh mesh = irregular_grid(120, 90);
  Region region;
  std::vector<Index> handle;
  for (Index v = 0; v < mesh.size(); ++v) {
    const double x = (mesh.positions.row(v) - mesh.positions.row(45 * 121 + 60)).norm() / mesh.box_diagonal();
    if (x < 0.2) region.vertices.push_back(v);
    if (x < 0.05) handle.push_back(v);
  }
  region.handles = {make_handle("handle", handle)};
  const auto pose = pose_of(Affine3d(Eigen::Translation3d(0, 0, 0.1 * mesh.box_diagonal())));
  const Points before =
      ProxyDeformer(mesh.positions, mesh.triangles, region, proxy_of(300)).evaluate(std::vector{pose});
  mesh.positions.row(0).setConstant(std::numeric_limits<double>::quiet_NaN());
  const Points after =
      ProxyDeformer(mesh.positions, mesh.triangles, region, proxy_of(300)).evaluate(std::vector{pose});
  EXPECT_TRUE(same_bytes(before.bottomRows(before.rows() - 1), after.bottomRows(after.rows() - 1)));
  mesh.positions.row(region.vertices[5]).setConstant(std::numeric_limits<double>::quiet_NaN());
  EXPECT_THROW(ProxyDeformer(mesh.positions, mesh.triangles, region, proxy_of(300)), Error);
}

TEST(Proxy, RefusesByNameWhatCannotBeSolved) {
  const Scene scene = make_scene(bumpy_sphere(4));
  Region region = held_foot(scene);
  region.handles[0].constrain_transform = false;
  region.handles[0].vertices = {scene.head.front()};
  region.fixed.clear();
  std::string of_direct = "none", of_proxy;
  try {
    Deformer(scene.mesh.positions, scene.mesh.triangles, region);
  } catch (const Error& error) {
    of_direct = error.what();
  }
  try {
    make_proxy(scene, region, 300);
  } catch (const Error& error) {
    of_proxy = error.what();
    EXPECT_EQ(error.code(), ErrorCode::unsolvable);
  }
  EXPECT_EQ(of_direct, of_proxy);
  try {
    make_proxy(scene, held_foot(scene), 0);
    ADD_FAILURE() << "nothing was thrown";
  } catch (const Error& error) {
    EXPECT_EQ(error.id(), "deform.proxy_without_vertices");
  }
  EXPECT_NO_THROW(make_proxy(scene, held_foot(scene), 1));
}

TEST(Proxy, CanBeCancelledAnywhere) {
  const Scene scene = make_scene(bumpy_sphere(4));
  int steps = 0;
  Context counting;
  counting.progress = [&](const Progress&) { ++steps; };
  const ProxyDeformer whole(scene.mesh.positions, scene.mesh.triangles, held_foot(scene), proxy_of(400),
                            counting);
  ASSERT_GT(steps, 3);
  for (int last = 1; last <= steps; ++last) {
    std::stop_source stop;
    int step = 0;
    Context context;
    context.stop_token = stop.get_token();
    context.progress = [&](const Progress&) {
      if (++step == last) stop.request_stop();
    };
    try {
      const ProxyDeformer proxy(scene.mesh.positions, scene.mesh.triangles, held_foot(scene), proxy_of(400),
                                context);
      // The number of reported steps depends on how the threads happen to share the work.
      EXPECT_LT(step, last) << "was not cancelled";
    } catch (const Error& error) {
      EXPECT_EQ(error.code(), ErrorCode::cancelled);
    }
  }
  // A cancelled evaluation does not change later ones.
  const std::vector poses{pose_of(head_move(scene))};
  const Points before = whole.evaluate(poses);
  std::stop_source stop;
  stop.request_stop();
  Context context;
  context.stop_token = stop.get_token();
  EXPECT_THROW(whole.evaluate(poses, context), Error);
  EXPECT_TRUE(same_bytes(whole.evaluate(poses), before));
}

}  // namespace
}  // namespace meshgraft::test
