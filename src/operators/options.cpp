#include <meshgraft/operators/affine_operator.h>

#include "core/require_between.h"

namespace meshgraft {

// All values are named, so that a changed default changes nothing here.
OperatorOptions OperatorOptions::as_published() {
  return {.weights = WeightScheme::uniform,
          .density = Density::ft05,
          .degenerate = DegenerateTreatment::ft05_noise,
          .apex_height_rel = 0.5,
          .noise_length_rel = 0.25,
          .noise_lengths = NoiseLengths::random,
          .flatness = 5e-5,
          .seed = 1,
          .laplacian_weight = 1,
          .opposite_pairs = true,
          .laplacian_order = 1};
}

bool has_integral_rows(const OperatorOptions& options) {
  return options.density == Density::aware && options.degenerate != DegenerateTreatment::ft05_noise;
}

void validate(const OperatorOptions& options) {
  require_between(options.apex_height_rel, 1e-3, 1e3, "apex_height_rel");
  require_between(options.noise_length_rel, 1e-3, 10, "noise_length_rel");
  require_between(options.flatness, 0, 1, "flatness");
  require_between(options.laplacian_weight, 1e-6, 1e6, "laplacian_weight");
  require_between(options.laplacian_order, 1, 3, "laplacian_order");
}

std::string_view to_string(WeightScheme value) {
  return value == WeightScheme::uniform ? "uniform" : "cotangent";
}

std::string_view to_string(Density value) { return value == Density::ft05 ? "ft05" : "aware"; }

std::string_view to_string(DegenerateTreatment value) {
  switch (value) {
    case DegenerateTreatment::automatic: return "auto";
    case DegenerateTreatment::ft05_noise: return "ft05-noise";
    case DegenerateTreatment::apex: return "apex";
  }
  return "auto";
}

std::string_view to_string(NoiseLengths value) { return value == NoiseLengths::random ? "random" : "equal"; }

}  // namespace meshgraft
