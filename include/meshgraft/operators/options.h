#pragma once

#include <cstdint>
#include <string_view>

namespace meshgraft {

/// Ring weights w_ij (FT05 equation 2).
enum class WeightScheme { uniform, cotangent };

/// Whether rows count by their number (FT05) or so that the same shape gives the same answer however finely
/// it is triangulated.
enum class Density { ft05, aware };

/// What is done where a ring is flat and P Pᵀ (nearly) singular.
enum class DegenerateTreatment {
  automatic,   ///< the better measured one: apex
  ft05_noise,  ///< move the vertex off its plane, solve, move back (FT05 section 3.2)
  apex,        ///< an extra unknown above each vertex
};

struct OperatorOptions {
  WeightScheme weights = WeightScheme::uniform;
  Density density = Density::aware;
  DegenerateTreatment degenerate = DegenerateTreatment::automatic;
  double apex_height_rel = 0.5;    ///< × mean incident edge length
  double noise_length_rel = 0.25;  ///< × mean incident edge length
  double flatness = 5e-5;          ///< smallest/largest eigenvalue of P Pᵀ below which a ring counts as flat
  std::uint64_t seed = 1;          ///< of the noise's signs
  double laplacian_weight = 20;    ///< λ of the energy λ E_L + E_R; FT05 has 1 (docs/method.md says why not)
  bool opposite_pairs = true;      ///< SF has the pairs opposite across an edge beside the edges, as in FT05
  int laplacian_order = 1;         ///< 1 = FT05's umbrella; 2, 3: higher-order Laplacian in E_L (section 6)
};

/// Throws Error(input) naming the field if a value is out of its range.
void validate(const OperatorOptions& options);

std::string_view to_string(WeightScheme value);
std::string_view to_string(Density value);
std::string_view to_string(DegenerateTreatment value);

}  // namespace meshgraft
