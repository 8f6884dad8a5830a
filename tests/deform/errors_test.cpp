// Problems that cannot be solved are refused with a name, a location and a remedy.
#include <limits>
#include <stop_token>
#include <string>
#include <string_view>
#include <vector>

#include <gtest/gtest.h>

#include <meshgraft/core/error.h>
#include <meshgraft/deform/deformer.h>
#include <meshgraft/deform/quick_frames.h>

#include "support/mesh_families.h"
#include "support/scene_edits.h"

namespace meshgraft::test {
namespace {

using Eigen::Vector3d;

/// Expects an Error with this id whose message contains `words`. Unsolvable edits must also have a remedy.
template <typename Call>
void expect_error(ErrorCode code, std::string_view id, const std::vector<std::string>& words, Call call) {
  try {
    call();
    ADD_FAILURE() << "nothing was thrown";
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), code) << error.what();
    EXPECT_EQ(error.id(), id) << error.what();
    for (const std::string& word : words)
      EXPECT_NE(std::string(error.what()).find(word), std::string::npos) << error.what();
    if (code == ErrorCode::unsolvable) {
      EXPECT_FALSE(error.remedy().empty()) << error.what();
    }
  }
}

void make(const TestMesh& mesh, const Region& region) { Deformer(mesh.positions, mesh.triangles, region); }

Region whole_with(std::vector<Handle> handles) {
  Region region;
  region.whole = true;
  region.handles = std::move(handles);
  return region;
}

TEST(Errors, CoplanarPositionsAloneDoNotFixAMap) {
  const Scene scene = make_scene(flat_sheet(18, 12));
  Region region = two_handles(scene);
  for (Handle& handle : region.handles) handle.constrain_transform = false;
  expect_error(ErrorCode::unsolvable, "deform.component_held_by_positions",
               {"component 1", "plane", "transform"}, [&] { make(scene.mesh, region); });
  region.handles[0].constrain_transform = true;
  EXPECT_NO_THROW(make(scene.mesh, region));
}

TEST(Errors, CollinearAndSinglePositionsDoNotFixAMap) {
  const TestMesh sheet = flat_sheet(10, 8), ball = bumpy_sphere(2);
  Handle point = make_handle("point", {5});
  point.constrain_transform = false;
  expect_error(ErrorCode::unsolvable, "deform.component_held_by_positions", {"one place"},
               [&] { make(ball, whole_with({point})); });
  TestMesh even = grid(10, 8);
  even.positions.col(2).setZero();
  Handle line = make_handle("line", {0, 1, 2, 3, 4});
  line.constrain_transform = false;
  expect_error(ErrorCode::unsolvable, "deform.component_held_by_positions", {"one line"},
               [&] { make(even, whole_with({line})); });
  EXPECT_NO_THROW(make(sheet, whole_with({make_handle("point", {5})})));
}

TEST(Errors, NoConstraintAtAll) {
  const TestMesh mesh = bumpy_sphere(2);
  expect_error(ErrorCode::unsolvable, "deform.component_not_held", {"component 1", "fixed"},
               [&] { make(mesh, whole_with({})); });
  Handle turning = make_handle("turning", {1, 2, 3});
  turning.constrain_position = false;
  expect_error(ErrorCode::unsolvable, "deform.component_not_held", {"component 1"},
               [&] { make(mesh, whole_with({turning})); });
}

TEST(Errors, AComponentWithoutConstraintIsNamed) {
  const TestMesh ball = bumpy_sphere(2);
  const Index n = ball.size();
  TestMesh two = ball;
  two.positions.conservativeResize(2 * n, 3);
  two.positions.bottomRows(n) = ball.positions.array() + 5.0;
  two.triangles.conservativeResize(2 * ball.triangles.rows(), 3);
  two.triangles.bottomRows(ball.triangles.rows()) = ball.triangles.array() + n;
  Region region = held_foot(make_scene(ball));
  expect_error(ErrorCode::unsolvable, "deform.component_not_held",
               {"component 2", "vertex " + std::to_string(n)}, [&] { make(two, region); });
  region.whole = false;
  for (Index v = 0; v < n; ++v) region.vertices.push_back(v);
  EXPECT_NO_THROW(make(two, region));
  // A region that covers a whole component has no fixed neighbour.
  Region second;
  for (Index v = n; v < 2 * n; ++v) second.vertices.push_back(v);
  expect_error(ErrorCode::unsolvable, "deform.component_not_held",
               {"component 1", "vertex " + std::to_string(n)}, [&] { make(two, second); });
}

TEST(Errors, HandlesAreNeitherEmptyNorShared) {
  const Scene scene = make_scene(bumpy_sphere(2));
  Region region = held_foot(scene);
  region.handles.push_back(make_handle("nobody", {}));
  const auto expect_refused = [&](std::string_view id, const std::vector<std::string>& words) {
    expect_error(ErrorCode::input, id, words, [&] { make(scene.mesh, region); });
  };
  expect_refused("deform.no_vertices", {"nobody", "no vertices"});
  region.handles[1].vertices = {scene.head.front()};
  expect_refused("deform.vertex_of_two_handles", {"nobody", "'head'"});
  region.handles[1].vertices = {scene.foot.front()};
  expect_refused("deform.vertex_also_fixed", {"nobody", "fixed"});
  region.handles[1].vertices = {scene.mesh.size()};
  expect_refused("core.no_such_vertex", {"nobody"});
  region.handles[1].vertices = {-1};
  expect_refused("core.no_such_vertex", {"nobody"});
}

TEST(Errors, WhatIsNotFiniteIsRefusedWithinReach) {
  Scene scene = make_scene(bumpy_sphere(3));
  for (const double value :
       {std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity()}) {
    Scene broken = scene;
    broken.mesh.positions(200, 1) = value;
    expect_error(ErrorCode::input, "deform.vertex_not_finite", {"vertex 200"},
                 [&] { make(broken.mesh, held_foot(scene)); });
  }
  const Deformer deformer(scene.mesh.positions, scene.mesh.triangles, held_foot(scene));
  for (int k = 0; k < 3; ++k) {
    HandlePose pose;
    pose.transform.translation()[k] = std::numeric_limits<double>::quiet_NaN();
    expect_error(ErrorCode::input, "deform.too_large_or_not_finite", {"position"},
                 [&] { deformer.evaluate(std::vector{pose}); });
  }
}

TEST(Errors, AProblemHasHandlesOrConstraintsPerVertex) {
  const Scene scene = make_scene(bumpy_sphere(2));
  const Index vertex = scene.head.front();
  DeformProblem problem{scene.mesh.positions, scene.mesh.triangles, held_foot(scene)};
  problem.constraints = {{vertex, scene.mesh.positions.row(vertex).transpose(), {}}};
  const std::string_view both = "deform.handles_and_constraints";
  expect_error(ErrorCode::usage, both, {"handles", "constraints"}, [&] { Deformer deformer(problem); });
  expect_error(ErrorCode::usage, both, {}, [&] { ProxyDeformer deformer(problem); });
  problem.region.handles.clear();
  EXPECT_NO_THROW(Deformer deformer(problem));
}

TEST(Errors, CallsOfTheWrongShapeAreRefused) {
  const Scene scene = make_scene(bumpy_sphere(2));
  const Deformer deformer(scene.mesh.positions, scene.mesh.triangles, held_foot(scene));
  const std::string_view size_mismatch = "core.size_mismatch";
  expect_error(ErrorCode::usage, size_mismatch, {}, [&] { deformer.evaluate(std::vector<HandlePose>{}); });
  Points small(3, 3);
  expect_error(ErrorCode::usage, size_mismatch, {},
               [&] { deformer.evaluate(std::vector{HandlePose{}}, small); });
  TestMesh broken = scene.mesh;
  broken.triangles(0, 0) = broken.size();
  expect_error(ErrorCode::input, "core.no_such_vertex", {"triangle 0"},
               [&] { make(broken, held_foot(scene)); });
  std::vector<DeformerOptions> wrong(3);
  wrong[0].operators.apex_height_rel = -1;
  wrong[1].operators.laplacian_order = 4;
  wrong[2].residual_corrections = -1;
  for (const DeformerOptions& options : wrong)
    expect_error(ErrorCode::input, "core.out_of_range", {},
                 [&] { Deformer(scene.mesh.positions, scene.mesh.triangles, held_foot(scene), options); });
}

TEST(Errors, AStopIsHeeded) {
  const Scene scene = make_scene(bumpy_sphere(3));
  std::stop_source stop;
  stop.request_stop();
  Context context;
  context.stop_token = stop.get_token();
  expect_error(ErrorCode::cancelled, "core.cancelled", {},
               [&] { Deformer(scene.mesh.positions, scene.mesh.triangles, held_foot(scene), {}, context); });
}

}  // namespace
}  // namespace meshgraft::test
