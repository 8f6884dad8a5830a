// Results do not depend on pose, order, other components, threads or earlier edits.
#include <algorithm>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include <meshgraft/deform/deformer.h>

#include "rotating_methods.h"
#include "support/mesh_families.h"
#include "support/scene_edits.h"
#include "support/variants.h"

namespace meshgraft::test {
namespace {

using Eigen::Affine3d;
using Eigen::AngleAxisd;
using Eigen::Matrix3d;
using Eigen::Vector3d;

TEST(Methods, ASimilarityOfTheSceneCarriesTheResultAlong) {
  for (const TestMesh& mesh : mesh_families()) {
    // Skips scenes at 1e9: moving them away from there changes how their coordinates are rounded.
    if (mesh.positions.cwiseAbs().maxCoeff() > 1e6) continue;
    const double size = mesh.box_diagonal();
    const Affine3d similarity = Eigen::Translation3d(size * Vector3d(2, -1, 3)) *
                                AngleAxisd(1.9, Vector3d(-1, 1, 3).normalized()) * Eigen::Scaling(3.7);
    for (const DeformerOptions& options : method_variants()) {
      SCOPED_TRACE(mesh.name + ", " + describe(options));
      const Scene scene = make_scene(mesh);
      Scene other = scene;
      other.mesh = transformed(mesh, similarity, "");
      const Affine3d move = head_move(scene);
      const Points result =
          make_deformer(scene, held_foot(scene), options).evaluate(std::vector{pose_of(move)});
      const Points other_result = make_deformer(other, held_foot(other), options)
                                      .evaluate(std::vector{pose_of(similarity * move * similarity.inverse())});
      EXPECT_LT(relative_distance(other.mesh, other_result, image(result, similarity)),
                step_tolerance(mesh, options));
    }
  }
}

/// Where every constraint moves, turning the whole mesh at rest does not change the result.
TEST(Methods, ThePoseAtRestDoesNotMatterWhereNothingStays) {
  for (const TestMesh& mesh : {bumpy_sphere(3), tube(14, 30), irregular_grid(22, 16), torus(14, 30)}) {
    const Scene scene = make_scene(mesh);
    const Affine3d pose = about_middle(mesh, Matrix3d(AngleAxisd(2.4, Vector3d(2, -1, 1).normalized())));
    const Affine3d foot_move(Eigen::Translation3d(0.1, 0.2, 0.3)), head = head_move(scene);
    const auto constraints_from = [&](const Affine3d& back) {
      std::vector<VertexConstraint> constraints;
      for (Index v : scene.foot)
        constraints.push_back({v, foot_move * Vector3d(mesh.positions.row(v)), Matrix3d(back.linear())});
      for (Index v : scene.head)
        constraints.push_back(
            {v, head * Vector3d(mesh.positions.row(v)), Matrix3d(head.linear() * back.linear())});
      return constraints;
    };
    for (const DeformerOptions& options : method_variants()) {
      SCOPED_TRACE(mesh.name + ", " + describe(options));
      const auto evaluate = [&](const TestMesh& posed, const Affine3d& back) {
        const auto constraints = constraints_from(back);
        return Deformer({posed.positions, posed.triangles, {.whole = true}, constraints}, options)
            .evaluate(constraints);
      };
      EXPECT_LT(relative_distance(mesh, evaluate(transformed(mesh, pose, ""), pose.inverse()),
                                  evaluate(mesh, Affine3d::Identity())),
                1e-9);
    }
  }
}

TEST(Methods, OrderDoesNotMatter) {
  for (const TestMesh& mesh : mesh_families()) {
    const Scene scene = make_scene(mesh);
    // Reverses the order of the vertices.
    const Index last = mesh.size() - 1;
    Scene other = scene;
    other.mesh.positions = mesh.positions.colwise().reverse();
    other.mesh.triangles = last - mesh.triangles.array();
    for (auto* end : {&other.foot, &other.head})
      for (Index& v : *end) v = last - v;
    std::reverse(other.head.begin(), other.head.end());
    for (const DeformerOptions& options : method_variants()) {
      SCOPED_TRACE(mesh.name + ", " + describe(options));
      const Affine3d move = head_move(scene);
      const Points expected =
          make_deformer(scene, held_foot(scene), options).evaluate(std::vector{pose_of(move)});
      const Points reversed =
          make_deformer(other, held_foot(other), options).evaluate(std::vector{pose_of(move)});
      const double rounding = eight_ulp(expected) / mesh.box_diagonal();
      EXPECT_LT(relative_distance(mesh, reversed.colwise().reverse(), expected),
                std::max(step_tolerance(mesh, options), rounding));
    }
  }
}

TEST(Methods, HandlesAndVertexConstraintsAreTheSameEdit) {
  const Scene scene = make_scene(bumpy_sphere(3));
  for (const DeformerOptions& options : method_variants()) {
    const Deformer by_handles = make_deformer(scene, two_handles(scene), options);
    const std::vector poses{HandlePose{}, turned(scene, 400)};
    const auto constraints = by_handles.constraints(poses);
    const Deformer by_vertices({scene.mesh.positions, scene.mesh.triangles, {.whole = true}, constraints},
                               options);
    EXPECT_TRUE(same_bytes(by_vertices.evaluate(constraints), by_handles.evaluate(poses)));
  }
}

/// A second component does not influence the first, however it is constrained.
TEST(Methods, OtherComponentsDoNotMatter) {
  const Scene scene = make_scene(tube(10, 16));
  const Index n = scene.mesh.size();
  const TestMesh other =
      transformed(tube(8, 24), Affine3d(Eigen::Translation3d(40, 0, 0) * Eigen::Scaling(3.0)), "");
  TestMesh both = scene.mesh;
  both.positions.conservativeResize(n + other.size(), Eigen::NoChange);
  both.positions.bottomRows(other.size()) = other.positions;
  const auto faces = both.triangles.rows();
  both.triangles.conservativeResize(faces + other.triangles.rows(), Eigen::NoChange);
  both.triangles.bottomRows(other.triangles.rows()) = other.triangles.array() + n;
  Region alone;
  alone.fixed = scene.foot;
  for (Index v = 0; v < n; ++v) alone.vertices.push_back(v);
  alone.handles.push_back(make_handle("head", scene.head));
  Region with_other = alone;
  with_other.whole = true;
  Scene other_scene = make_scene(other);
  for (auto* end : {&other_scene.foot, &other_scene.head}) {
    for (Index& v : *end) v += n;
    with_other.handles.push_back(make_handle("other " + std::to_string(with_other.handles.size()), *end));
    with_other.handles.back().constrain_transform = false;
  }
  for (DeformerOptions options : method_variants()) {
    // With stiffness the components would interact, since its rows are scaled by the area of all free vertices.
    options.stiffness = 0;
    const HandlePose head = turned(scene, 120, Vector3d::UnitX()), still;
    const Points a = Deformer(both.positions, both.triangles, alone, options).evaluate(std::vector{head});
    const Points b =
        Deformer(both.positions, both.triangles, with_other, options).evaluate(std::vector{head, still, still});
    // The co-rotational iterations of all components stop together, so their number may differ.
    const double tolerance = is_corotational(options.method) ? 2e-3 : 1e-9;
    EXPECT_LT(largest_distance(a, b), tolerance * scene.mesh.box_diagonal()) << describe(options);
  }
  const Points stiff =
      Deformer(both.positions, both.triangles, with_other)
          .evaluate(std::vector{turned(scene, 120, Vector3d::UnitX()), HandlePose{}, HandlePose{}});
  EXPECT_LT(largest_distance(stiff.bottomRows(other.size()), other.positions), 1e-9 * other.box_diagonal());
}

TEST(Methods, ResultsDoNotDependOnThreadsOrHistory) {
  const Scene scene = make_scene(irregular_grid(60, 50));
  Context one, two;
  one.threads = 1;
  two.threads = 2;
  const Deformer first(scene.mesh.positions, scene.mesh.triangles, held_foot(scene), {}, one);
  const Deformer second(scene.mesh.positions, scene.mesh.triangles, held_foot(scene), {}, two);
  const std::vector move{turned(scene, 100)};
  const Points expected = first.evaluate(move, one);
  EXPECT_TRUE(same_bytes(second.evaluate(move, two), expected));
  second.evaluate(std::vector{turned(scene, 300)}, two);
  EXPECT_TRUE(same_bytes(second.evaluate(move, two), expected));
}

}  // namespace
}  // namespace meshgraft::test
