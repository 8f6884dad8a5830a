#pragma once

#include <meshgraft/linalg/linear_solver.h>
#include <meshgraft/mesh/mesh.h>

namespace meshgraft {

/// Seconds per stage and figures of the set-up.
struct DeformerSummary {
  Index free_vertices = 0;   ///< vertices whose position is solved for
  Index fixed_vertices = 0;  ///< fixed vertices of the region
  Index handle_vertices = 0;
  Index degenerate_vertices = 0;  ///< free vertices with a flat or near-flat neighbourhood
  /// Set if patch, operator and bisection tree are shared with another Deformer (`Deformer::with_region`).
  bool reused = false;
  double assemble_seconds = 0;
  double analyse_seconds = 0;
  double factorise_seconds = 0;  ///< includes the scalar systems that spread rotations
  SolverStatistics solver{};
};

/// Figures of one evaluation.
struct EvaluationReport {
  double residual = 0;                 ///< ‖Aᵀ(b − A x)‖ / ‖Aᵀ b‖, 0 for a zero right-hand side
  double max_transform_deviation = 0;  ///< max ‖M_c(x) − W_c‖_F over constrained transforms
  int iterations = 0;                  ///< co-rotational steps made
  int solver_iterations = 0;           ///< iterations of the backend `iterative` in the last solve
  double last_rotation_change = 0;     ///< RMS change of F asked for by the last step, radians
  Index inverted_maps = 0;             ///< free vertices whose local map has a determinant of 0 or less
  /// Set if transforms were blended linearly because a constraint reflects or flattens, so that its transform
  /// has no logarithm.
  bool fell_back_to_linear = false;
};

}  // namespace meshgraft
