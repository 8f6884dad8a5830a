#pragma once

#include <vector>

#include "baselines.h"
#include "edit_problem.h"
#include "linalg/sparse.h"

namespace meshgraft::baselines {

// Each function returns the positions of the patch's vertices, n×3, at the patch's scale.

Points deform_botsch_kobbelt_2004(const EditProblem& problem, const BaselineOptions& options,
                                  const Context& context);
Points deform_lipman_2004(const EditProblem& problem, const BaselineOptions& options, const Context& context);
Points deform_sorkine_2004(const EditProblem& problem, const BaselineOptions& options, const Context& context);
Points deform_yu_2004(const EditProblem& problem, const BaselineOptions& options, const Context& context);

struct ArapResult {
  Points positions;
  std::vector<double> energies;  ///< the method's energy at the start and after each iteration
};
ArapResult deform_arap_2007(const EditProblem& problem, const BaselineOptions& options, const Context& context);
ArapResult deform_sr_arap_2015(const EditProblem& problem, const BaselineOptions& options,
                               const Context& context);
ArapResult deform_smooth_arap_2025(const EditProblem& problem, const BaselineOptions& options,
                                   const Context& context);

/// The naive editing that several methods begin with: ‖D x − δ‖² → min. D is the Laplacian and δ = D p are
/// the detail vectors, not rotated.
class NaiveLaplacian {
 public:
  NaiveLaplacian(const EditProblem& problem, WeightScheme weights, SolverBackend backend,
                 const Context& context);
  const Columns& delta() const { return delta_; }
  /// Solves for other detail vectors (n×3) and returns the positions.
  Points solve(const Columns& delta, const Context& context) const;

 private:
  const EditProblem& problem_;
  SparseRows D_, D_transposed_;
  Columns delta_;
  std::unique_ptr<KnownRowsSolver> solver_;
};

}  // namespace meshgraft::baselines
