#include <meshgraft/baselines/baselines.h>

#include <algorithm>

#include <fmt/format.h>

#include <meshgraft/core/error.h>

#include "methods.h"

namespace meshgraft {

namespace {

/// Returns how many rings around the free vertices enter the method's equations for them.
int depth_of(Baseline method, const BaselineOptions& options) {
  switch (method) {
    case Baseline::botsch_kobbelt_2004: return options.harmonic_order - 1;
    case Baseline::lipman_2004: return options.normal_rings + 1;
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
    case Baseline::sorkine_alexa_2007: return baselines::deform_arap_2007(problem, options, context).positions;
  }
  throw Error(ErrorCode::usage, "there is no such baseline method");
}

}  // namespace

std::string_view to_string(Baseline value) {
  switch (value) {
    case Baseline::botsch_kobbelt_2004: return "botsch-kobbelt-2004";
    case Baseline::lipman_2004: return "lipman-2004";
    case Baseline::sorkine_2004: return "sorkine-2004";
    case Baseline::yu_2004: return "yu-2004";
    case Baseline::sorkine_alexa_2007: return "arap-2007";
  }
  return "unknown";
}

void validate(const BaselineOptions& options) {
  const auto require = [](bool holds, const char* field, const char* range) {
    if (!holds) throw Error(ErrorCode::input, fmt::format("it must be {}", range), field);
  };
  require(options.harmonic_order >= 1 && options.harmonic_order <= 3, "harmonic_order", "1, 2 or 3");
  require(options.detail_size_rel >= 0 && options.detail_size_rel <= 1e6, "detail_size_rel", "from 0 to 1e6");
  require(options.normal_rings >= 0 && options.normal_rings <= 1000, "normal_rings", "from 0 to 1000");
  require(options.arap_iterations >= 0, "arap_iterations", "at least 0");
  require(options.arap_tolerance >= 0, "arap_tolerance", "at least 0");
}

Points deform_by(Baseline method, const Points& rest, const Triangles& triangles, std::span<const Index> region,
                 std::span<const VertexConstraint> constraints, const BaselineOptions& options,
                 const Context& context) {
  validate(options);
  const baselines::EditProblem problem =
      baselines::make_problem(rest, triangles, region, constraints, depth_of(method, options), context);
  Points result = rest;
  if (problem.size() > 0) {
    const Points positions = solve(method, problem, options, context);
    for (Index v = 0; v < problem.size(); ++v) {
      if (problem.known[v]) continue;
      const Index global = problem.patch.vertices[v];
      result.row(global) += problem.patch.scale * (positions.row(v) - problem.rest().row(v));
      if (!result.row(global).allFinite())
        throw Error(ErrorCode::unsolvable, fmt::format("the solution is not finite at vertex {}", global), "",
                    "Move the constraints by less, or repair the surface there");
    }
  }
  for (const VertexConstraint& constraint : constraints)
    if (constraint.position) result.row(constraint.vertex) = constraint.position->transpose();
  return result;
}

}  // namespace meshgraft
