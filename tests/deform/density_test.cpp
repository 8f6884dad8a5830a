// The same shape gives the same deformation however finely its parts are triangulated.
#include <map>
#include <utility>

#include <gtest/gtest.h>

#include <meshgraft/deform/deformer.h>

#include "support/density_cases.h"
#include "support/variants.h"

namespace meshgraft::test {
namespace {

std::vector<DensityDeviation> deviations_of(const DeformerOptions& options,
                                            std::span<const RowShape> shapes = all_row_shapes,
                                            const RowTurns& turns = {}) {
  const auto solve = [&](const TestMesh& mesh, const std::vector<std::vector<VertexConstraint>>& edits) {
    const Deformer deformer({mesh.positions, mesh.triangles, {.whole = true}, edits.front()}, options);
    std::vector<Points> results;
    for (const auto& edit : edits) results.push_back(deformer.evaluate(edit));
    return results;
  };
  return density_deviations(solve, shapes, turns);
}

TEST(Density, ProfilesFollowTheShapeNotTheTriangles) {
  std::map<RowEdit, double> worst;
  for (const DensityDeviation& d : deviations_of(linear_method())) {
    SCOPED_TRACE(std::string(to_string(d.shape)) + ", " + to_string(d.edit) + ", " +
                 std::to_string(d.cells_along) + " cells, 1:" + std::to_string(d.ratio));
    EXPECT_LT(d.deviation, 0.10);
    worst[d.edit] = std::max(worst[d.edit], d.deviation);
  }
  for (const auto& [edit, deviation] : worst)
    RecordProperty(std::string("worst_") + to_string(edit) + "_percent", std::to_string(100 * deviation));
}

TEST(Density, TreatmentsAndWeightsKeepTheRule) {
  const std::pair<const char*, OperatorOptions> others[] = {
      {"apex_cotangent", {.weights = WeightScheme::cotangent}},
      {"noise_uniform", {.degenerate = DegenerateTreatment::ft05_noise}},
      {"noise_cotangent", {.weights = WeightScheme::cotangent, .degenerate = DegenerateTreatment::ft05_noise}},
  };
  for (const auto& [name, options] : others) {
    double worst = 0;
    for (const DensityDeviation& d : deviations_of(linear_method(options)))
      worst = std::max(worst, d.deviation);
    EXPECT_LT(worst, 0.10) << name;
    RecordProperty(std::string("worst_percent_") + name, std::to_string(100 * worst));
  }
}

TEST(Density, LargeTurnsKeepTheRule) {
  const RowTurns large{.bend_deg = 120, .twist_deg = 135};
  for (const DeformMethod method : {DeformMethod::rotation_aware, DeformMethod::corotational}) {
    std::map<RowEdit, double> worst;
    for (const DensityDeviation& d : deviations_of({.method = method}, all_row_shapes, large)) {
      SCOPED_TRACE(std::string(to_string(method)) + ", " + to_string(d.shape) + ", " + to_string(d.edit) +
                   ", " + std::to_string(d.cells_along) + " cells, 1:" + std::to_string(d.ratio));
      EXPECT_LT(d.deviation, 0.10);
      worst[d.edit] = std::max(worst[d.edit], d.deviation);
    }
    for (const auto& [edit, deviation] : worst)
      RecordProperty(std::string(to_string(method)) + "_worst_" + to_string(edit) + "_percent",
                     std::to_string(100 * deviation));
  }
}

// Shows that the measure can fail: the rows as FT05 writes them do depend on the triangles.
TEST(Density, TheRowsAsWrittenDependOnTheTriangles) {
  constexpr RowShape shapes[] = {RowShape::tube};
  double worst = 0;
  for (const DensityDeviation& d : deviations_of(linear_method({.density = Density::ft05}), shapes))
    worst = std::max(worst, d.deviation);
  EXPECT_GT(worst, 0.30);
}

}  // namespace
}  // namespace meshgraft::test
