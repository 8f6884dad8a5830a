// Prints how much a deformation depends on how finely the same shape is triangulated, for every density rule,
// treatment and weighting: `meshgraft_density_report`.
#include <algorithm>
#include <cstdio>

#include <meshgraft/deform/deformer.h>

#include "support/density_cases.h"
#include "support/variants.h"

namespace {

using namespace meshgraft;

void print_table(const OperatorOptions& options) {
  const auto solve = [&](const test::TestMesh& mesh, const std::vector<std::vector<VertexConstraint>>& edits) {
    const Deformer deformer({mesh.positions, mesh.triangles, {.whole = true}, edits.front()},
                            test::linear_method(options));
    std::vector<Points> results;
    for (const auto& edit : edits) results.push_back(deformer.evaluate(edit));
    return results;
  };
  std::printf("\ndensity %s, treatment %s, weights %s\n", to_string(options.density).data(),
              to_string(options.degenerate).data(), to_string(options.weights).data());
  std::printf("  %-6s %-18s %10s %10s %10s\n", "shape", "cells along", "stretch", "bend", "twist");
  const auto deviations = test::density_deviations(solve);
  double worst = 0;
  for (std::size_t k = 0; k + 2 < deviations.size(); k += 3) {
    const auto& d = deviations[k];
    std::printf("  %-6s %3d, halves 1:%-4d %8.2f %% %8.2f %% %8.2f %%\n", to_string(d.shape), d.cells_along,
                d.ratio, 100 * d.deviation, 100 * deviations[k + 1].deviation,
                100 * deviations[k + 2].deviation);
    for (std::size_t e = 0; e < 3; ++e) worst = std::max(worst, deviations[k + e].deviation);
  }
  std::printf("  worst %.2f %%\n", 100 * worst);
}

}  // namespace

int main() {
  std::printf(
      "Largest deviation of stretch, bend and twist profiles from those of an even mesh with 40 cells along\n"
      "its length, relative to the profiles' amplitudes.\n");
  for (const Density density : {Density::aware, Density::ft05})
    for (const DegenerateTreatment treatment : {DegenerateTreatment::apex, DegenerateTreatment::ft05_noise})
      for (const WeightScheme weights : {WeightScheme::uniform, WeightScheme::cotangent})
        print_table({.weights = weights, .density = density, .degenerate = treatment});
  return 0;
}
