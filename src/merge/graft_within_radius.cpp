#include "graft_within_radius.h"

#include <algorithm>
#include <set>
#include <utility>

#include <meshgraft/core/error.h>
#include <meshgraft/mesh/topology.h>

#include "merge/facts.h"
#include "shape_report.h"

namespace meshgraft {

namespace {

/// Throws Error(input) if a vertex of a loop, which moves to the target's loop, is fixed.
void require_loops_not_fixed(const std::vector<Index>& fixed, std::span<const LoopPair> pairs) {
  const std::set<Index> staying(fixed.begin(), fixed.end());
  for (const LoopPair& pair : pairs)
    for (const Index v : pair.source)
      if (staying.contains(v)) throw Error(facts::merge::FixedOnLoop{.vertex = v}, "fixed");
}

/// Solves with the vertices `far` beyond the influence radius, and adds the seconds to those of the search.
FoundGraft solve_beside(std::span<const Index> far, const PosedSource& source,
                        std::span<const VertexConstraint> constraints, const MergeOptions& options,
                        const Context& context) {
  FoundGraft found;
  found.graft =
      solve_graft(source.posed, source.triangles, constraints, far, source.component, options, context);
  const DeformerSummary& summary = found.graft.summary;
  found.assemble_seconds = summary.assemble_seconds;
  found.factorise_seconds = summary.analyse_seconds + summary.factorise_seconds;
  found.shape = measure_shape(source.rest, found.graft.positions, source.triangles, far, source.component);
  found.shape.inverted = found.graft.evaluation.inverted_maps;
  return found;
}

bool is_better(const ShapeReport& shape, const ShapeReport& best) {
  constexpr double better = 0.03;  // chosen: a smaller gain is not worth a larger solve
  return shape.inverted < best.inverted ||
         (shape.inverted == best.inverted && shape.smallest_singular_p5 >= best.smallest_singular_p5 + better);
}

bool is_good(const ShapeReport& shape) {
  // Measured: the public merge tasks end at 0.78 or more, but for the CAD part (docs/merging.md, "Shape").
  constexpr double roomy = 0.7;
  return shape.inverted == 0 && shape.smallest_singular_p5 >= roomy;
}

}  // namespace

FoundGraft graft_within_radius(const PosedSource& source, std::span<const VertexConstraint> constraints,
                               const MergeOptions& options, int fewest_doublings, const Context& context) {
  constexpr double fewest_far = 0.05;       // chosen, × all vertices: fewer do not determine a similarity well
  constexpr int most_doublings = 3;         // chosen: eight radii are most of a source
  constexpr std::size_t most_near = 20000;  // chosen, vertices: solves of more take seconds
  const auto count = static_cast<std::size_t>(source.rest.rows());
  const bool radius_given = options.reach.rings || options.reach.length;
  require_loops_not_fixed(options.fixed, source.pairs);
  if (options.pose == MergePose::keep && !options.fixed.empty() && !radius_given)
    return solve_beside(options.fixed, source, constraints, options, context);
  const bool one_radius = radius_given || options.shape == MergeShape::ft05 || options.pose == MergePose::keep;
  const IndexLists rings = vertex_rings(static_cast<Index>(count), source.triangles, context);
  std::vector<std::vector<Index>> loops;
  for (const LoopPair& pair : source.pairs) loops.push_back(pair.source);

  const auto too_large = [&](std::span<const Index> far) {
    const bool hardly_any = static_cast<double>(far.size()) < fewest_far * static_cast<double>(count);
    return hardly_any || count - far.size() > most_near;
  };
  int doublings = one_radius ? 0 : fewest_doublings;
  std::vector<Index> far;
  for (;; --doublings) {
    far = beyond_influence_radius(source.rest, rings, loops, options.reach, 1 << doublings);
    if (doublings == 0 || !too_large(far)) break;
  }
  FoundGraft best = solve_beside(far, source, constraints, options, context);
  best.doublings = doublings;
  while (!is_good(best.shape) && !one_radius && ++doublings <= most_doublings) {
    std::vector<Index> farther =
        beyond_influence_radius(source.rest, rings, loops, options.reach, 1 << doublings);
    if (too_large(farther) || farther.size() == far.size()) break;
    far = std::move(farther);
    FoundGraft found = solve_beside(far, source, constraints, options, context);
    found.doublings = doublings;
    found.assemble_seconds += best.assemble_seconds;
    found.factorise_seconds += best.factorise_seconds;
    if (is_better(found.shape, best.shape)) {
      best = std::move(found);
    } else {
      best.assemble_seconds = found.assemble_seconds;
      best.factorise_seconds = found.factorise_seconds;
    }
  }
  return best;
}

}  // namespace meshgraft
