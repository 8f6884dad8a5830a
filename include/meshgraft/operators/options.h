#pragma once

#include <cstdint>
#include <string_view>

namespace meshgraft {

/// Ring weights w_ij (FT05 equation 2).
enum class WeightScheme { uniform, cotangent };

/// Weighting of the energy's rows: equal for all rows (`ft05`), or so that the same shape gives the same
/// result however finely it is triangulated (`aware`).
enum class Density { ft05, aware };

/// Treatments of a flat ring, where P Pᵀ is (nearly) singular.
enum class DegenerateTreatment {
  automatic,   ///< the one that measured better: apex
  ft05_noise,  ///< move the vertex off its plane, solve, move back (FT05 section 3.2)
  apex,        ///< an extra unknown above each vertex
};

struct OperatorOptions {
  WeightScheme weights = WeightScheme::uniform;
  Density density = Density::aware;
  DegenerateTreatment degenerate = DegenerateTreatment::automatic;
  double apex_height_rel = 0.5;    ///< × mean incident edge length
  double noise_length_rel = 0.25;  ///< × mean incident edge length
  /// Ratio of smallest to largest eigenvalue of P Pᵀ below which a ring counts as flat.
  double flatness = 5e-5;
  std::uint64_t seed = 1;  ///< seed of the noise's signs
  /// Weight λ of the energy λ E_L + E_R; 1 in FT05 (docs/method.md explains the default).
  double laplacian_weight = 20;
  /// SF has the pairs opposite across an edge in addition to the edges, as in FT05.
  bool opposite_pairs = true;
  int laplacian_order = 1;  ///< 1 = FT05's umbrella; 2, 3: higher-order Laplacian in E_L (section 6)
};

/// Throws Error(input) with the id core.out_of_range, at the field, if a value is out of its range.
void validate(const OperatorOptions& options);

std::string_view to_string(WeightScheme value);
std::string_view to_string(Density value);
std::string_view to_string(DegenerateTreatment value);

}  // namespace meshgraft
