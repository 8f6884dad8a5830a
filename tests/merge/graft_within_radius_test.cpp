#include "merge/graft_within_radius.h"

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include <meshgraft/core/error.h>

#include "merge/graft_scenes.h"
#include "merge/shape_report.h"
#include "support/scene_edits.h"

namespace meshgraft {
namespace {

/// Constrains the loop to be `squeeze` times as wide in one direction, with transforms that stay rotations.
std::vector<VertexConstraint> squeezing_constraints(const test::GraftScene& scene, double squeeze) {
  std::vector<VertexConstraint> constraints = test::constraints_of(scene, Eigen::Affine3d::Identity());
  for (VertexConstraint& held : constraints) held.position->x() *= squeeze;
  return constraints;
}

std::vector<LoopPair> pairs_of(const test::GraftScene& scene) { return {{scene.loops[0], {}}}; }

FoundGraft graft_of(const test::GraftScene& scene, const std::vector<VertexConstraint>& constraints,
                    const MergeOptions& options) {
  const std::vector<LoopPair> pairs = pairs_of(scene);
  return graft_within_radius(
      {scene.mesh.positions, scene.mesh.positions, scene.mesh.triangles, scene.component, pairs}, constraints,
      options, 0, {});
}

/// Few iterations: the search compares grafts, however well they have settled.
constexpr int few_iterations = 6;

/// Returns the graft within a number of radii, without a search.
FoundGraft graft_at(const test::GraftScene& scene, const std::vector<VertexConstraint>& constraints,
                    const MergeOptions& options, double radii) {
  const Points& rest = scene.mesh.positions;
  const std::vector<Index> far = beyond_influence_radius(rest, scene.rings, scene.loops, options.reach, radii);
  FoundGraft found;
  found.graft = solve_graft(rest, scene.mesh.triangles, constraints, far, scene.component, options, {});
  found.shape = measure_shape(rest, found.graft.positions, scene.mesh.triangles, far, scene.component);
  found.shape.inverted = found.graft.evaluation.inverted_maps;
  return found;
}

void expect_same(const FoundGraft& found, const FoundGraft& expected, const std::string& name) {
  EXPECT_EQ(found.graft.positions, expected.graft.positions) << name;
  EXPECT_EQ(found.shape.smallest_singular_p5, expected.shape.smallest_singular_p5) << name;
  EXPECT_EQ(found.shape.inverted, expected.shape.inverted) << name;
}

TEST(GraftWithinRadius, UsesTheRequestedRadius) {
  for (const test::GraftScene& scene : test::graft_scenes()) {
    const auto constraints = squeezing_constraints(scene, 0.3);
    std::vector<Points> results;
    for (const Reach& reach : {Reach{.rings = 2}, Reach{.rings = 4}, Reach{.length = 0.9}})
      for (const MergePose pose : {MergePose::find, MergePose::keep}) {
        const MergeOptions options{.pose = pose, .reach = reach, .deformer = {.iterations = few_iterations}};
        const FoundGraft found = graft_of(scene, constraints, options);
        expect_same(found, graft_at(scene, constraints, options, 1), scene.mesh.name);
        if (pose == MergePose::keep) results.push_back(found.graft.positions);
      }
    EXPECT_NE(results[0], results[1]) << scene.mesh.name;
  }
}

TEST(GraftWithinRadius, DoesNotSearchWhereTheRadiusHardlyMatters) {
  for (const test::GraftScene& scene : test::graft_scenes()) {
    const auto constraints = squeezing_constraints(scene, 0.3);
    for (const MergeOptions& options :
         {MergeOptions{.pose = MergePose::keep}, MergeOptions{.shape = MergeShape::ft05}})
      expect_same(graft_of(scene, constraints, options), graft_at(scene, constraints, options, 1),
                  scene.mesh.name);
  }
}

TEST(GraftWithinRadius, DoublesTheRadiusOnlyWhileThatHelps) {
  int doubled = 0;
  const MergeOptions options{.deformer = {.iterations = few_iterations}};
  for (const test::GraftScene& scene : test::graft_scenes())
    for (const double squeeze : {1.0, 0.8, 0.5, 0.3, -0.5}) {
      const auto constraints = squeezing_constraints(scene, squeeze);
      const FoundGraft found = graft_of(scene, constraints, options);
      // Up to the radius that was found, each smaller one squeezes the source, and clearly more than that one.
      bool is_tried = false;
      for (const double radii : {1, 2, 4, 8}) {
        const FoundGraft smaller = graft_at(scene, constraints, options, radii);
        is_tried = found.graft.positions == smaller.graft.positions;
        if (is_tried) break;
        ++doubled;
        EXPECT_TRUE(smaller.shape.inverted > 0 || smaller.shape.smallest_singular_p5 < 0.7)
            << scene.mesh.name << " " << squeeze << " " << radii;
        EXPECT_TRUE(found.shape.inverted < smaller.shape.inverted ||
                    (found.shape.inverted == smaller.shape.inverted &&
                     found.shape.smallest_singular_p5 >= smaller.shape.smallest_singular_p5 + 0.03))
            << scene.mesh.name << " " << squeeze << " " << radii;
      }
      EXPECT_TRUE(is_tried) << scene.mesh.name << " " << squeeze;
    }
  EXPECT_GE(doubled, 3);
}

TEST(GraftWithinRadius, LeavesASourceInPlaceWhereItIs) {
  for (const test::GraftScene& scene : test::graft_scenes()) {
    const auto constraints = test::constraints_of(scene, Eigen::Affine3d::Identity());
    for (const MergePose pose : {MergePose::find, MergePose::keep})
      for (const MergeShape shape : {MergeShape::similar, MergeShape::ft05}) {
        const FoundGraft found = graft_of(scene, constraints, {.pose = pose, .shape = shape});
        EXPECT_LT(test::largest_distance(found.graft.positions, scene.mesh.positions), 1e-9) << scene.mesh.name;
        EXPECT_NEAR(found.shape.smallest_singular_p5, 1, 1e-6) << scene.mesh.name;
        EXPECT_EQ(found.shape.inverted, 0) << scene.mesh.name;
      }
  }
}

TEST(GraftWithinRadius, FixedVerticesBesideTheLoopsStay) {
  for (const test::GraftScene& scene : test::graft_scenes()) {
    const auto constraints = squeezing_constraints(scene, 0.8);
    MergeOptions options{.pose = MergePose::keep};
    const std::vector<Index> near = grow_rings(scene.loops[0], 1, scene.rings);
    for (Index v = 0; v < scene.mesh.size(); ++v)
      if (v % 2 == 0 || !std::binary_search(near.begin(), near.end(), v)) options.fixed.push_back(v);
    std::erase_if(options.fixed,
                  [&](Index v) { return std::ranges::find(scene.loops[0], v) != scene.loops[0].end(); });
    const FoundGraft found = graft_of(scene, constraints, options);
    for (const Index v : options.fixed)
      EXPECT_EQ(found.graft.positions.row(v), scene.mesh.positions.row(v)) << scene.mesh.name;
    for (const VertexConstraint& held : constraints)
      EXPECT_EQ(found.graft.positions.row(held.vertex), held.position->transpose()) << scene.mesh.name;
  }
}

TEST(GraftWithinRadius, ARequestedRadiusPrecedesFixedVertices) {
  const test::GraftScene scene = test::graft_scenes()[0];
  const auto constraints = squeezing_constraints(scene, 0.8);
  MergeOptions options{.pose = MergePose::keep, .reach = {.rings = 3}};
  const FoundGraft expected = graft_of(scene, constraints, options);
  options.fixed = {scene.mesh.size() - 1};
  expect_same(graft_of(scene, constraints, options), expected, scene.mesh.name);
}

TEST(GraftWithinRadius, RefusesFixedVerticesOnLoops) {
  for (const test::GraftScene& scene : test::graft_scenes())
    for (const std::size_t count : {std::size_t{1}, scene.loops[0].size()}) {
      MergeOptions options{.pose = MergePose::keep};
      options.fixed.assign(scene.loops[0].begin(), scene.loops[0].begin() + static_cast<std::ptrdiff_t>(count));
      options.fixed.push_back(scene.mesh.size() - 1);
      try {
        graft_of(scene, squeezing_constraints(scene, 0.8), options);
        ADD_FAILURE() << scene.mesh.name;
      } catch (const Error& error) {
        EXPECT_EQ(error.id(), "merge.fixed_on_loop");
        EXPECT_EQ(error.fact().get<std::int64_t>("vertex"), scene.loops[0][0]);
        EXPECT_EQ(error.location().text(), "fixed");
        EXPECT_EQ(error.code(), ErrorCode::input);
      }
    }
}

}  // namespace
}  // namespace meshgraft
