// Affine maps are reproduced at every size, up to 100,000 vertices.
#include <gtest/gtest.h>

#include <meshgraft/deform/deformer.h>

#include "core/stopwatch.h"
#include "deform/setup/memory_estimate.h"
#include "support/mesh_families.h"
#include "support/scene_edits.h"
#include "support/variants.h"

namespace meshgraft::test {
namespace {

class Large : public testing::TestWithParam<Index> {};

TEST_P(Large, MemoryIsAsEstimated) {
  for (const TestMesh& mesh : large_families(GetParam()))
    for (const DegenerateTreatment treatment : {DegenerateTreatment::apex, DegenerateTreatment::ft05_noise}) {
      SCOPED_TRACE(mesh.name + ", " + std::string(to_string(treatment)));
      const DeformerOptions options = linear_method({.degenerate = treatment});
      const Deformer deformer(mesh.positions, mesh.triangles, two_handles(make_scene(mesh, 0.03, 0.03)),
                              options);
      const double ratio = static_cast<double>(estimated_memory(deformer.summary().free_vertices, options)) /
                           static_cast<double>(deformer.summary().solver.peak_memory_bytes);
      EXPECT_GT(ratio, 0.5);
      EXPECT_LT(ratio, 2.0);
    }
}

TEST_P(Large, AffineMapsAreReproduced) {
  for (const TestMesh& mesh : large_families(GetParam())) {
    SCOPED_TRACE(mesh.name + ", " + std::to_string(mesh.size()) + " vertices");
    const Scene scene = make_scene(mesh);
    const Deformer deformer(mesh.positions, mesh.triangles, two_handles(scene), linear_method());
    double worst = 0;
    for (const auto& [name, linear] : linear_maps()) {
      const Eigen::Affine3d map = about_middle(mesh, linear);
      const Points result = deformer.evaluate(std::vector{pose_of(map), pose_of(map)});
      const double error = largest_distance(result, image(mesh.positions, map)) / mesh.box_diagonal();
      EXPECT_LT(error, 1e-10) << name;
      worst = std::max(worst, error);
    }
    RecordProperty("error_of_box_" + std::to_string(mesh.size()), std::to_string(worst * 1e12) + "e-12");
  }
}

// Flat sides, and a curved surface of genus 1. `Large` has all families at 55,000.
TEST(HundredThousand, FollowAffineMaps) {
  for (const TestMesh& mesh : {bar(72, 358), torus(183, 549)}) {
    SCOPED_TRACE(mesh.name);
    ASSERT_GE(mesh.size(), 100'000);
    const Stopwatch watch;
    const Deformer deformer(mesh.positions, mesh.triangles, two_handles(make_scene(mesh)), linear_method());
    for (const auto& [name, linear] : linear_maps()) {
      const Eigen::Affine3d map = about_middle(mesh, linear);
      const Points result = deformer.evaluate(std::vector{pose_of(map), pose_of(map)});
      EXPECT_LT(largest_distance(result, image(mesh.positions, map)), 1e-9 * mesh.box_diagonal()) << name;
    }
    RecordProperty(mesh.name,
                   std::to_string(mesh.size()) + " vertices, seconds " + std::to_string(watch.seconds()));
  }
}

INSTANTIATE_TEST_SUITE_P(Sizes, Large, testing::Values(2500, 20000, 50000),
                         [](const auto& size) { return std::to_string(size.param); });

}  // namespace
}  // namespace meshgraft::test
