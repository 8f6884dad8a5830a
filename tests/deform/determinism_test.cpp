// The same edit gives the same bytes in every run and for any number of threads.
#include <string>

#include <gtest/gtest.h>

#include <meshgraft/deform/deformer.h>

#include "support/mesh_families.h"
#include "support/scene_edits.h"

namespace meshgraft::test {
namespace {

Points edit(const Scene& scene, const OperatorOptions& options, int threads) {
  Context context;
  context.threads = threads;
  return Deformer(scene.mesh.positions, scene.mesh.triangles, held_foot(scene), {.operators = options}, context)
      .evaluate(std::vector{pose_of(head_move(scene))}, context);
}

// Meshes that are large enough for work to be shared among threads.
struct LargeMesh {
  std::string name;
  TestMesh (*make)();
};

class DeterminismOf : public testing::TestWithParam<LargeMesh> {};

TEST_P(DeterminismOf, SameBytesTwiceAndForAnyNumberOfThreads) {
  const Scene scene = make_scene(GetParam().make());
  for (const DegenerateTreatment treatment : {DegenerateTreatment::apex, DegenerateTreatment::ft05_noise}) {
    SCOPED_TRACE(to_string(treatment));
    OperatorOptions options;
    options.degenerate = treatment;
    const Points one = edit(scene, options, 1);
    EXPECT_TRUE(same_bytes(edit(scene, options, 1), one));
    EXPECT_TRUE(same_bytes(edit(scene, options, 2), one));
  }
}

INSTANTIATE_TEST_SUITE_P(Meshes, DeterminismOf,
                         testing::Values(LargeMesh{"bumpy_sphere", [] { return bumpy_sphere(4); }},
                                         LargeMesh{"irregular_grid", [] { return irregular_grid(60, 50); }},
                                         LargeMesh{"flat_sheet", [] { return flat_sheet(50, 40); }},
                                         LargeMesh{"bar", [] { return bar(6, 40); }}),
                         [](const auto& tested) { return tested.param.name; });

TEST(Determinism, EvaluationsDoNotRememberEachOther) {
  const Scene scene = make_scene(bumpy_sphere(3));
  const Deformer deformer(scene.mesh.positions, scene.mesh.triangles, held_foot(scene));
  const std::vector move{pose_of(head_move(scene))}, still{HandlePose{}};
  const Points first = deformer.evaluate(move);
  EXPECT_TRUE(same_bytes(deformer.evaluate(still), scene.mesh.positions));
  EXPECT_TRUE(same_bytes(deformer.evaluate(move), first));
}

}  // namespace
}  // namespace meshgraft::test
