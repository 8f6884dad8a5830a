// The backend `iterative` is as accurate on large meshes as direct solvers, and needs as few iterations as on
// small ones. The sizes are those where a factor still fits into memory.
#include <gtest/gtest.h>

#include <meshgraft/deform/deformer.h>

#include "support/mesh_families.h"
#include "support/scene_edits.h"
#include "support/variants.h"

namespace meshgraft::test {
namespace {

class IterativeLarge : public testing::TestWithParam<Index> {};

TEST_P(IterativeLarge, FindsWhatDirectSolversFind) {
  for (const TestMesh& mesh : large_families(GetParam()))
    for (const DegenerateTreatment treatment : {DegenerateTreatment::apex, DegenerateTreatment::ft05_noise}) {
      SCOPED_TRACE(mesh.name + ", " + std::string(to_string(treatment)));
      const Scene scene = make_scene(mesh);
      OperatorOptions operators;
      operators.degenerate = treatment;
      DeformerOptions options = linear_method(operators);
      EvaluationReport report;
      const auto result = [&](SolverBackend backend) {
        options.backend = backend;
        return Deformer(mesh.positions, mesh.triangles, held_foot(scene), options)
            .evaluate(std::vector{pose_of(head_move(scene))}, {}, &report);
      };
      const Points direct = result(SolverBackend::automatic), iterative = result(SolverBackend::iterative);
      const double error = largest_distance(iterative, direct) / mesh.box_diagonal();
      EXPECT_LT(error, 1e-6);
      if (treatment == DegenerateTreatment::apex) {
        EXPECT_LT(report.solver_iterations, 30);
      }
      RecordProperty(mesh.name + ", " + std::string(to_string(treatment)),
                     std::to_string(error * 1e9) + "e-9 of the box, iterations " +
                         std::to_string(report.solver_iterations));
    }
}

TEST_P(IterativeLarge, FindsTheFieldThatDirectSolversFind) {
  for (const TestMesh& mesh : large_families(GetParam())) {
    SCOPED_TRACE(mesh.name);
    const Scene scene = make_scene(mesh);
    const auto result = [&](SolverBackend backend) {
      return Deformer(mesh.positions, mesh.triangles, held_foot(scene), {.backend = backend})
          .evaluate(std::vector{pose_of(head_move(scene))});
    };
    const double error = largest_distance(result(SolverBackend::iterative), result(SolverBackend::automatic)) /
                         mesh.box_diagonal();
    EXPECT_LT(error, 1e-4);  // either may settle a step earlier
    RecordProperty(mesh.name, std::to_string(error * 1e9) + "e-9 of the box");
  }
}

INSTANTIATE_TEST_SUITE_P(Sizes, IterativeLarge, testing::Values(20000, 50000),
                         [](const auto& size) { return std::to_string(size.param); });

}  // namespace
}  // namespace meshgraft::test
