// The backend `iterative` finds what the factorisation finds, at a million vertices.
#include <algorithm>
#include <cstdint>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include <meshgraft/deform/deformer.h>

#include "core/memory.h"
#include "core/stopwatch.h"
#include "support/mesh_families.h"
#include "support/scene_edits.h"
#include "support/variants.h"

namespace meshgraft::test {
namespace {

// The treatment `ft05_noise` needs half the memory of the apexes. Most vertices of the sheet are not flat, so
// that the noise moves few of them.
TEST(Million, IterationsFindWhatTheFactorFinds) {
  constexpr std::uint64_t needed = 8'000'000'000;
  if (available_memory() < needed) GTEST_SKIP() << "takes 7 GB";
  const TestMesh mesh = irregular_grid(1000, 1000);
  ASSERT_GE(mesh.size(), 1'000'000);
  const Scene scene = make_scene(mesh);
  DeformerOptions options = linear_method({.degenerate = DegenerateTreatment::ft05_noise});
  const auto result = [&](SolverBackend backend) {
    options.backend = backend;
    const Stopwatch watch;
    EvaluationReport report;
    Points positions = Deformer(mesh.positions, mesh.triangles, held_foot(scene), options)
                           .evaluate(std::vector{pose_of(head_move(scene))}, {}, &report);
    RecordProperty(std::string(name_of(backend)), "seconds " + std::to_string(watch.seconds()) +
                                                      ", iterations " +
                                                      std::to_string(report.solver_iterations));
    EXPECT_LT(report.residual, 1e-6);
    return positions;
  };
  const Points direct = result(SolverBackend::multifrontal), iterative = result(SolverBackend::iterative);
  const double error = largest_distance(iterative, direct) / mesh.box_diagonal();
  RecordProperty("error_of_box", std::to_string(error * 1e9) + "e-9");
  EXPECT_LT(error, 2e-7);
}

}  // namespace
}  // namespace meshgraft::test
