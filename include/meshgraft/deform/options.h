#pragma once

#include <string_view>

#include <meshgraft/linalg/linear_solver.h>
#include <meshgraft/operators/options.h>

namespace meshgraft {

/// The rule by which rotations spread from the constraints (docs/methods.md). The methods share one matrix,
/// apart from `stiffness`. They differ in the field of maps F_i on the right-hand side of E_R:
/// ‖(M_i − M_j) d − (F_i − F_j) d‖².
enum class DeformMethod {
  ft05,            ///< F = I: maps are blended linearly (Fu & Tai 2005)
  rotation_aware,  ///< F blends the logarithms of the constraints' rotations and stretches
  corotational,    ///< starts from `rotation_aware`, then F follows the rotations of the surface itself
};

std::string_view to_string(DeformMethod value);

struct DeformerOptions {
  // The method.
  DeformMethod method = DeformMethod::corotational;
  /// The weight μ ≥ 0 of extra rows on edges that preserve lengths (not used by `ft05`). 0 bends most evenly;
  /// larger values are more rigid. Under `Density::aware` μ is relative to bending over the region's size,
  /// otherwise the rows have the plain weight μ.
  double stiffness = 60;
  int iterations = 20;  ///< largest number of co-rotational steps
  /// Length over which the co-rotational field is smoothed, × the width of the surface between constraints.
  double smoothing_length_rel = 0.09;
  // The operator.
  OperatorOptions operators{};
  // The solve.
  SolverBackend backend = SolverBackend::automatic;
  int residual_corrections = 1;  ///< corrections per solve by the residual of the rectangular system
};

}  // namespace meshgraft
