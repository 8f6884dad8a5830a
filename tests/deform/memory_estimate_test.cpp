// What a factorisation is said to need beforehand is what it takes, within a factor of 1.5.
#include <string>

#include <gtest/gtest.h>

#include <meshgraft/core/error.h>
#include <meshgraft/deform/memory_estimate.h>

#include "support/mesh_families.h"
#include "support/scene_edits.h"
#include "support/variants.h"

namespace meshgraft::test {
namespace {

void expect_close(const TestMesh& mesh, SolverBackend backend) {
  const Scene scene = make_scene(mesh, 0.03, 0.03);
  for (const DegenerateTreatment treatment : {DegenerateTreatment::apex, DegenerateTreatment::ft05_noise}) {
    DeformerOptions options = linear_method({.degenerate = treatment});
    options.backend = backend;
    const Deformer deformer(mesh.positions, mesh.triangles, held_foot(scene), options);
    const Index free = deformer.summary().free_vertices;
    SCOPED_TRACE(mesh.name + ", " + deformer.summary().solver.backend + ", " +
                 std::string(to_string(treatment)) + ", " + std::to_string(free) + " free vertices");
    const double ratio = static_cast<double>(estimated_memory(free, options)) /
                         static_cast<double>(deformer.summary().solver.peak_memory_bytes);
    EXPECT_GT(ratio, 1 / 1.5);
    EXPECT_LT(ratio, 1.5);
  }
}

TEST(MemoryEstimate, IsCloseOnSmallRegions) {
  for (const TestMesh& mesh : large_families(2500))
    for (const SolverBackend backend : available_backends()) expect_close(mesh, backend);
}

TEST(MemoryEstimate, GrowsWithTheRegion) {
  std::int64_t last = estimated_memory(0);
  EXPECT_EQ(last, 0);
  for (const Index free : {1, 2, 10, 1000, 1'000'000, 100'000'000}) {
    EXPECT_GT(estimated_memory(free), last);
    last = estimated_memory(free);
  }
  EXPECT_THROW(estimated_memory(-1), Error);
}

}  // namespace
}  // namespace meshgraft::test
