// The same edit gives the same bytes for any number of threads.
#include <vector>

#include <gtest/gtest.h>

#include <meshgraft/deform/deformer.h>

#include "baselines/baselines.h"
#include "support/mesh_families.h"
#include "support/scene_edits.h"

namespace meshgraft::test {
namespace {

TEST(BaselineDeterminism, SameBytesForAnyNumberOfThreads) {
  for (const TestMesh& mesh : {bumpy_sphere(4), irregular_grid(60, 50)}) {  // large enough for several threads
    const Scene scene = make_scene(mesh);
    const std::vector<VertexConstraint> constraints =
        Deformer(mesh.positions, mesh.triangles, two_handles(scene))
            .constraints(std::vector{HandlePose{}, pose_of(head_move(scene))});
    for (const Baseline method : all_baselines) {
      const auto edit = [&](int threads) {
        return deform_by(method, {mesh.positions, mesh.triangles, {.whole = true}, constraints},
                         {.arap_iterations = 5}, {.threads = threads});
      };
      EXPECT_TRUE(same_bytes(edit(1), edit(2))) << mesh.name << ", " << to_string(method);
    }
  }
}

}  // namespace
}  // namespace meshgraft::test
