#include "baselines.h"

#include <algorithm>

#include <meshgraft/core/error.h>

#include "baselines/facts.h"
#include "core/facts.h"
#include "core/require_between.h"
#include "methods.h"

namespace meshgraft {

namespace {

/// Returns how many rings around the free vertices enter the method's equations for them.
int depth_of(Baseline method, const BaselineOptions& options, Index vertices) {
  switch (method) {
    case Baseline::botsch_kobbelt_2004: return options.harmonic_order - 1;
    case Baseline::lipman_2004: return options.normal_rings + 1;
    case Baseline::sr_arap_2015: return vertices;  // the rotations of held cells are unknown, too
    default: return 1;
  }
}

Points solve(Baseline method, const baselines::EditProblem& problem, const BaselineOptions& options,
             const Context& context) {
  switch (method) {
    case Baseline::botsch_kobbelt_2004: return baselines::deform_botsch_kobbelt_2004(problem, options, context);
    case Baseline::lipman_2004: return baselines::deform_lipman_2004(problem, options, context);
    case Baseline::sorkine_2004: return baselines::deform_sorkine_2004(problem, options, context);
    case Baseline::yu_2004: return baselines::deform_yu_2004(problem, options, context);
    case Baseline::arap_2007: return baselines::deform_arap_2007(problem, options, context).positions;
    case Baseline::sr_arap_2015: return baselines::deform_sr_arap_2015(problem, options, context).positions;
    case Baseline::smooth_arap_2025:
      return baselines::deform_smooth_arap_2025(problem, options, context).positions;
  }
  throw Error(facts::baselines::NoSuchMethod{});
}

}  // namespace

std::string_view to_string(Baseline value) {
  switch (value) {
    case Baseline::botsch_kobbelt_2004: return "botsch-kobbelt-2004";
    case Baseline::lipman_2004: return "lipman-2004";
    case Baseline::sorkine_2004: return "sorkine-2004";
    case Baseline::yu_2004: return "yu-2004";
    case Baseline::arap_2007: return "arap-2007";
    case Baseline::sr_arap_2015: return "sr-arap-2015";
    case Baseline::smooth_arap_2025: return "smooth-arap-2025";
  }
  return "unknown";
}

void validate(const BaselineOptions& options) {
  const auto require_positive = [](double value, const char* field) {
    if (!(value >= 0)) throw Error(facts::core::Negative{.value = value}, field);
  };
  require_between(options.harmonic_order, 1, 3, "harmonic_order");
  require_between(options.detail_size_rel, 0, 1e6, "detail_size_rel");
  require_between(options.normal_rings, 0, 1000, "normal_rings");
  require_positive(options.arap_iterations, "arap_iterations");
  require_positive(options.arap_tolerance, "arap_tolerance");
  require_positive(options.sr_alpha, "sr_alpha");
  require_between(options.smoothness, 0, 1, "smoothness");
}

Points deform_by(Baseline method, const DeformProblem& edit, const BaselineOptions& options,
                 const Context& context) {
  validate(options);
  const baselines::EditProblem problem =
      baselines::make_problem(edit, depth_of(method, options, static_cast<Index>(edit.rest.rows())), context);
  Points result = edit.rest;
  if (problem.size() > 0) {
    const Points positions = solve(method, problem, options, context);
    for (Index v = 0; v < problem.size(); ++v) {
      if (problem.mask.position[v]) continue;
      const Index global = problem.patch.vertices[v];
      result.row(global) += problem.patch.scale * (positions.row(v) - problem.rest().row(v));
      if (!result.row(global).allFinite()) throw Error(facts::baselines::SolutionNotFinite{.vertex = global});
    }
  }
  for (const VertexConstraint& constraint : edit.constraints)
    if (constraint.position) result.row(constraint.vertex) = constraint.position->transpose();
  return result;
}

}  // namespace meshgraft
