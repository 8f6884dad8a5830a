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

TEST(Determinism, SameBytesTwiceAndForAnyNumberOfThreads) {
  // These meshes are large enough for work to be shared among threads.
  for (const TestMesh& mesh : {bumpy_sphere(4), irregular_grid(60, 50), flat_sheet(50, 40), bar(6, 40)})
    for (const DegenerateTreatment treatment : {DegenerateTreatment::apex, DegenerateTreatment::ft05_noise}) {
      OperatorOptions options;
      options.degenerate = treatment;
      SCOPED_TRACE(mesh.name + ", " + std::string(to_string(treatment)));
      const Scene scene = make_scene(mesh);
      const Points one = edit(scene, options, 1);
      EXPECT_TRUE(same_bytes(edit(scene, options, 1), one));
      EXPECT_TRUE(same_bytes(edit(scene, options, 2), one));
    }
}

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
