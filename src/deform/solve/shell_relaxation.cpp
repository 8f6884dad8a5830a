#include "shell_relaxation.h"

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include <meshgraft/core/error.h>

#include "linalg/backends.h"
#include "linalg/facts.h"

namespace meshgraft {

namespace {

constexpr int most_steps = 30;
constexpr double settled_gain = 1e-4;        // of the energy, in one step
constexpr double negligible_energy = 1e-20;  // that of strains of 1e-10

/// Returns whether no face loses more than seven tenths of its area in one step and is left with less than a
/// tenth of what it wants.
bool keeps_areas(const std::vector<double>& before, const std::vector<double>& after) {
  for (std::size_t f = 0; f < before.size(); ++f)
    if (after[f] < std::min(0.3 * before[f], 0.1)) return false;
  return true;
}

}  // namespace

ShellRelaxation::ShellRelaxation(const ConstrainedSystem& system, const LimbTwist& limbs, SolverBackend backend,
                                 const Context& context)
    : system_(system),
      backend_(backend == SolverBackend::iterative ? SolverBackend::automatic : backend),
      surface_(system, limbs, context),
      pattern_(surface_, context) {
  if (!surface_.moving().empty()) analysed_ = analysed_solver(context);
}

std::unique_ptr<LinearSolver> ShellRelaxation::analysed_solver(const Context& context) const {
  OrderingGraph graph{{}, &system_.operators()->rings(), system_.bisection()};
  for (const Index v : surface_.moving()) graph.group.insert(graph.group.end(), 3, v);
  auto solver = make_solver(backend_);
  solver->analyse(pattern_.zero(), graph, context);
  return solver;
}

/// The state between two steps.
struct ShellRelaxation::Iterate {
  Points positions;
  std::vector<double> areas;  ///< per face, × the area that it wants
  double energy = 0, damping = 1e-2;
  double foretold = 0;  ///< gain of energy that the model of the latest step has
  CurvatureModel model = CurvatureModel::secant;
};

ShellRelaxation::Result ShellRelaxation::relax(const RestStrain& strain, Points positions,
                                               const Context& context) const {
  Result result{.positions = std::move(positions)};
  if (surface_.moving().empty()) return result;
  const ShellEnergy shell(surface_, pattern_, surface_.metric(strain, context));
  Iterate at{.positions = std::move(result.positions)};
  at.areas = shell.area_ratios(at.positions);
  at.energy = shell.value(at.positions, context);
  std::unique_ptr<LinearSolver> solver;
  const Context within{context.threads, {}, context.stop_token};  // of a step, which is one stage
  double progress = 0;
  context.step("shell", progress);
  result.settled = at.energy < negligible_energy;
  while (!result.settled && result.steps < most_steps) {
    if (!solver) solver = copy_analysis(*analysed_);
    if (!solver) solver = analysed_solver(within);
    const double before = at.energy;
    const bool found = step(shell, *solver, at, within);
    const double gain = (found ? before - at.energy : at.foretold) / before;
    result.settled = gain < settled_gain;
    if (!found) break;
    ++result.steps;
    // Gains fall about as powers, so their logarithm tells how far the steps are.
    progress = std::max(progress, std::log(std::max(gain, settled_gain)) / std::log(settled_gain));
    context.step("shell", progress);
  }
  result.positions = std::move(at.positions);
  return result;
}

/// Makes one step that lowers the energy. Returns false, and changes nothing but the damping, if it finds none.
bool ShellRelaxation::step(const ShellEnergy& shell, LinearSolver& solver, Iterate& at,
                           const Context& context) const {
  constexpr int most_attempts = 8;
  Eigen::VectorXd descent;
  NormalMatrix curvature;
  shell.differentiate(at.positions, at.model, descent, curvature, context);
  for (int attempt = 0; attempt < most_attempts; ++attempt, at.damping *= 6) {
    NormalMatrix damped = curvature;
    shell.add_damping(at.damping, damped);
    try {
      solver.factorise_and_free(damped, context);
    } catch (const Error& error) {
      if (error.id() != facts::linalg::NotPositiveDefinite::id) throw;
      continue;  // rounding; with more damping it is
    }
    const Eigen::VectorXd change = solver.solve(descent, context).col(0);
    at.foretold = 0.5 * descent.dot(change);
    for (const double share : {1.0, 0.4}) {
      Points moved = at.positions;
      for (std::size_t u = 0; u < surface_.moving().size(); ++u)
        moved.row(surface_.moving()[u]) +=
            share * change.segment<3>(static_cast<Eigen::Index>(3 * u)).transpose();
      const double energy = shell.value(moved, context);
      if (!(energy < at.energy)) continue;
      std::vector<double> areas = shell.area_ratios(moved);
      if (!keeps_areas(at.areas, areas)) continue;
      const double gain = (at.energy - energy) / ((2 - share) * share * at.foretold);
      if (share < 1 || gain < 0.2)
        at.damping *= 2;
      else if (gain > 0.6)
        at.damping = std::max(at.damping / 4, 1e-10);
      if (gain < 0.75) at.model = CurvatureModel::tangent;
      at.positions = std::move(moved);
      at.areas = std::move(areas);
      at.energy = energy;
      return true;
    }
  }
  return false;
}

}  // namespace meshgraft
