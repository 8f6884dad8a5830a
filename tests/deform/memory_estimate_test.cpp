// The memory estimate of a factorisation is right within a factor of two.
#include <string>

#include <gtest/gtest.h>

#include <meshgraft/core/error.h>

#include "deform/setup/memory_estimate.h"
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
    SCOPED_TRACE(mesh.name + ", " + std::string(name_of(deformer.summary().solver.backend)) + ", " +
                 std::string(to_string(treatment)) + ", " + std::to_string(free) + " free vertices");
    const double ratio = static_cast<double>(estimated_memory(free, options)) /
                         static_cast<double>(deformer.summary().solver.peak_memory_bytes);
    EXPECT_GT(ratio, 0.5);
    EXPECT_LT(ratio, 2.0);
  }
}

TEST(MemoryEstimate, IsCloseOnSmallRegions) {
  for (const TestMesh& mesh : large_families(2500))
    for (const SolverBackend backend : available_backends())
      if (backend != SolverBackend::iterative) expect_close(mesh, backend);
}

TEST(SolvePath, SuitsTheRegionAndTheMemory) {
  constexpr std::uint64_t gigabyte = 1'000'000'000;
  const DeformerOptions options;
  EXPECT_EQ(choose_path(0, options, gigabyte), SolvePath::direct);
  EXPECT_EQ(choose_path(50'000, options, 8 * gigabyte), SolvePath::direct);
  EXPECT_EQ(choose_path(1'000'000, options, 1000 * gigabyte), SolvePath::direct);
  EXPECT_EQ(choose_path(2'000'000, options, 1000 * gigabyte), SolvePath::iterative);
  EXPECT_EQ(choose_path(1'000'000, {.method = DeformMethod::ft05}, 1000 * gigabyte), SolvePath::iterative);
  EXPECT_EQ(choose_path(1'000'000, options, 2 * gigabyte), SolvePath::proxy);
  // More memory never gives a coarser path, and a larger region never a finer one.
  for (const auto treatment : {DegenerateTreatment::apex, DegenerateTreatment::ft05_noise}) {
    const DeformerOptions some{.operators = {.degenerate = treatment}};
    for (Index free = 1000; free < 100'000'000; free *= 2) {
      SolvePath last = SolvePath::proxy;
      for (std::uint64_t memory = 1'000'000; memory < 1000 * gigabyte; memory *= 2) {
        const SolvePath path = choose_path(free, some, memory);
        EXPECT_LE(static_cast<int>(path), static_cast<int>(last));
        EXPECT_GE(static_cast<int>(choose_path(2 * free, some, memory)), static_cast<int>(path));
        last = path;
      }
    }
  }
}

TEST(SolvePath, FactorisesFieldsWhereTheyFitBesideIterations) {
  if (available_backends().front() == SolverBackend::eigen) GTEST_SKIP() << "Eigen's factors take far more";
  for (const Index free : {100'000, 1'000'000, 10'000'000}) {
    std::uint64_t least = 1'000'000;  // memory with which iterations fit
    while (choose_path(free, {.backend = SolverBackend::iterative}, least) == SolvePath::proxy)
      least += least / 16;
    EXPECT_FALSE(factors_of_fields_fit(free, {}, least));
    EXPECT_TRUE(factors_of_fields_fit(free, {}, 2 * least));
  }
}

TEST(SolvePath, KeepsABackendThatIsAskedFor) {
  for (const SolverBackend backend : available_backends()) {
    const DeformerOptions options{.backend = backend};
    EXPECT_EQ(choose_path(2'000'000, options, std::uint64_t{1} << 45),
              backend == SolverBackend::iterative ? SolvePath::iterative : SolvePath::direct);
    EXPECT_EQ(choose_path(2'000'000, options, 1'000'000), SolvePath::proxy);
  }
}

TEST(SolvePath, GivesAProxyThatFits) {
  const DeformerOptions options;
  Index last = 0;
  for (std::uint64_t memory = 1'000'000; memory < 100'000'000'000; memory *= 2) {
    const Index vertices = proxy_vertices_for(options, memory);
    EXPECT_GE(vertices, last);
    EXPECT_GE(vertices, 2000);
    last = vertices;
  }
  EXPECT_GE(proxy_vertices_for(options, 2'000'000'000), 8000);
}

TEST(MemoryEstimate, GrowsWithTheRegion) {
  std::int64_t last = estimated_memory(0);
  EXPECT_EQ(last, 0);
  for (const Index free : {1, 2, 10, 1000, 1'000'000, 100'000'000}) {
    EXPECT_GT(estimated_memory(free), last);
    last = estimated_memory(free);
  }
  try {
    estimated_memory(-1);
    ADD_FAILURE() << "nothing was thrown";
  } catch (const Error& error) {
    EXPECT_EQ(error.id(), "deform.negative_count");
  }
}

}  // namespace
}  // namespace meshgraft::test
