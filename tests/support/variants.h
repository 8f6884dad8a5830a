#pragma once

#include <string>
#include <vector>

#include <meshgraft/deform/deformer.h>
#include <meshgraft/operators/affine_operator.h>

namespace meshgraft::test {

inline std::string describe(const OperatorOptions& options) {
  return std::string(to_string(options.degenerate)) + ", " + std::string(to_string(options.weights)) + ", " +
         std::string(to_string(options.density));
}

/// Returns options of the linear method, whose laws hold in every pose.
inline DeformerOptions linear_method(const OperatorOptions& options = {}) {
  return {.method = DeformMethod::ft05, .operators = options};
}

/// Returns every combination of weights and densities with the given treatments.
inline std::vector<OperatorOptions> operator_variants(std::vector<DegenerateTreatment> treatments = {
                                                          DegenerateTreatment::apex,
                                                          DegenerateTreatment::ft05_noise}) {
  std::vector<OperatorOptions> variants;
  for (const DegenerateTreatment treatment : treatments)
    for (const WeightScheme weights : {WeightScheme::uniform, WeightScheme::cotangent})
      for (const Density density : {Density::ft05, Density::aware})
        variants.push_back({.weights = weights, .density = density, .degenerate = treatment});
  return variants;
}

}  // namespace meshgraft::test
