#include "methods.h"
#include "spoke_cells.h"

namespace meshgraft::baselines {

namespace {

/// The local and the global step over the cells that contain a free vertex.
class Arap {
 public:
  Arap(const EditProblem& problem, const BaselineOptions& options, const Context& context)
      : cells_(problem, near_free(problem), context),
        solver_(cells_.C(), problem.mask.position, options.backend, context) {}

  void solve(Columns& x) const { solver_.solve(cells_.C(), cells_.right_hand_side(), x, cells_.context(), 1); }
  void fit_rotations(const Columns& x) { cells_.fit_rotations(x); }
  double energy(const Columns& x) { return cells_.energy(x); }

 private:
  SpokeCells cells_;
  KnownRowsSolver solver_;
};

}  // namespace

ArapResult deform_arap_2007(const EditProblem& problem, const BaselineOptions& options,
                            const Context& context) {
  return deform_by_steps<Arap>(problem, options, context);
}

}  // namespace meshgraft::baselines
