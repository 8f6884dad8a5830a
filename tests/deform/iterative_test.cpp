// The backend `iterative` agrees with the direct backends to a millionth of the box.
#include <gtest/gtest.h>

#include <meshgraft/core/error.h>
#include <meshgraft/deform/deformer.h>

#include "support/mesh_families.h"
#include "support/scene_edits.h"
#include "support/variants.h"

namespace meshgraft::test {
namespace {

DeformerOptions with_backend(DeformerOptions options, SolverBackend backend) {
  options.backend = backend;
  return options;
}

Points edit(const Scene& scene, const DeformerOptions& options, const Context& context = {}) {
  return Deformer(scene.mesh.positions, scene.mesh.triangles, held_foot(scene), options, context)
      .evaluate(std::vector{pose_of(head_move(scene))}, context);
}

void expect_same(const Scene& scene, const DeformerOptions& options) {
  Points direct;
  try {
    direct = edit(scene, options);
  } catch (const Error& error) {
    GTEST_LOG_(INFO) << scene.mesh.name << ": not for direct solvers either: " << error.what();
    return;
  }
  const Points iterative = edit(scene, with_backend(options, SolverBackend::iterative));
  EXPECT_LT(largest_distance(iterative, direct), 1e-6 * scene.mesh.box_diagonal());
}

TEST(Iterative, FindsWhatDirectSolversFindOnEveryFamily) {
  for (const TestMesh& mesh : mesh_families())
    for (const DegenerateTreatment treatment : {DegenerateTreatment::apex, DegenerateTreatment::ft05_noise}) {
      SCOPED_TRACE(mesh.name + ", " + std::string(to_string(treatment)));
      OperatorOptions operators;
      operators.degenerate = treatment;
      expect_same(make_scene(mesh), linear_method(operators));
    }
}

TEST(Iterative, FindsWhatDirectSolversFindByEveryMethodAndVariant) {
  const Scene scene = make_scene(bumpy_sphere(3));
  for (const DeformMethod method :
       {DeformMethod::ft05, DeformMethod::rotation_aware, DeformMethod::corotational}) {
    SCOPED_TRACE(std::string(to_string(method)));
    expect_same(scene, {.method = method});
  }
  for (const OperatorOptions& operators : operator_variants()) {
    SCOPED_TRACE(describe(operators));
    expect_same(scene, linear_method(operators));
  }
}

TEST(Iterative, ReproducesAffineMaps) {
  for (const TestMesh& mesh : {bumpy_sphere(4), irregular_grid(60, 50), flat_sheet(50, 40), bar(6, 40)}) {
    SCOPED_TRACE(mesh.name);
    const Scene scene = make_scene(mesh);
    const Deformer deformer(mesh.positions, mesh.triangles, two_handles(scene),
                            with_backend(linear_method(), SolverBackend::iterative));
    for (const auto& [name, linear] : linear_maps()) {
      const Eigen::Affine3d map = about_middle(mesh, linear);
      const Points result = deformer.evaluate(std::vector{pose_of(map), pose_of(map)});
      EXPECT_LT(largest_distance(result, image(mesh.positions, map)), 1e-7 * mesh.box_diagonal()) << name;
    }
    EXPECT_TRUE(same_bytes(deformer.evaluate(std::vector{HandlePose{}, HandlePose{}}), mesh.positions));
  }
}

TEST(Iterative, FollowsFeatures) {
  const TestMesh mesh = bumpy_sphere(4);
  const Scene scene = make_scene(mesh);
  for (const bool similarity : {false, true}) {
    Region region = held_foot(scene);
    Feature feature;
    for (Index v = 0; v < mesh.size(); ++v)
      if (mesh.positions(v, 0) > 0.8 && std::abs(mesh.positions(v, 2)) < 0.4) feature.vertices.push_back(v);
    ASSERT_GT(feature.vertices.size(), 20u);
    feature.similarity = similarity;
    region.features = {feature};
    const auto result = [&](SolverBackend backend) {
      return Deformer(mesh.positions, mesh.triangles, region, with_backend(linear_method(), backend))
          .evaluate(std::vector{pose_of(head_move(scene))});
    };
    EXPECT_LT(largest_distance(result(SolverBackend::iterative), result(SolverBackend::automatic)),
              1e-6 * mesh.box_diagonal());
  }
}

TEST(Iterative, GivesTheSameBytesForAnyNumberOfThreads) {
  for (const TestMesh& mesh : {bumpy_sphere(4), flat_sheet(50, 40)}) {
    const Scene scene = make_scene(mesh);
    const DeformerOptions options{.backend = SolverBackend::iterative};
    const Points one = edit(scene, options, {.threads = 1});
    EXPECT_TRUE(same_bytes(edit(scene, options, {.threads = 2}), one)) << mesh.name;
  }
}

TEST(Iterative, StopsWhenAsked) {
  const Scene scene = make_scene(bumpy_sphere(4));
  const Deformer deformer(scene.mesh.positions, scene.mesh.triangles, held_foot(scene),
                          with_backend(linear_method(), SolverBackend::iterative));
  std::stop_source stop;
  Context context;
  context.stop_token = stop.get_token();
  context.progress = [&](const Progress& progress) {
    if (progress.stage == "solve") stop.request_stop();
  };
  EXPECT_THROW(deformer.evaluate(std::vector{pose_of(head_move(scene))}, context), Error);
}

}  // namespace
}  // namespace meshgraft::test
