#pragma once

#include <memory>

#include <meshgraft/core/context.h>
#include <meshgraft/linalg/linear_solver.h>

#include "shell_energy.h"
#include "shell_surface.h"

namespace meshgraft {

/// Moves a solved surface to the nearby minimum of its `ShellEnergy`: by Gauss-Newton steps, damped as by
/// Levenberg and Marquardt. Each step factorises a matrix of three unknowns per moving vertex.
class ShellRelaxation {
 public:
  /// `system` and `limbs` must outlive this. With the backend `iterative` the shell still factorises.
  ShellRelaxation(const ConstrainedSystem& system, const LimbTwist& limbs, SolverBackend backend,
                  const Context& context);

  struct Result {
    Points positions;  ///< of the patch, patch units
    int steps = 0;
    bool settled = true;  ///< whether the last step changed the energy by less than 0.01 %
  };
  /// Starts from `positions` (patch units). The wanted shape is the one at rest under a
  /// strain.
  Result relax(const RestStrain& strain, Points positions, const Context& context) const;

  const ShellSurface& surface() const { return surface_; }

 private:
  struct Iterate;
  bool step(const ShellEnergy& shell, LinearSolver& solver, Iterate& at, const Context& context) const;
  std::unique_ptr<LinearSolver> analysed_solver(const Context& context) const;

  const ConstrainedSystem& system_;
  SolverBackend backend_;
  ShellSurface surface_;
  ShellPattern pattern_;
  std::unique_ptr<LinearSolver> analysed_;  ///< null if nothing moves
};

}  // namespace meshgraft
