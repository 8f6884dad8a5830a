#include "match_by_arc_length.h"

#include <algorithm>

#include <meshgraft/core/error.h>

#include "merge/facts.h"

namespace meshgraft {

namespace {

Index index_in(const std::vector<Index>& loop, Index vertex) {
  const auto found = std::find(loop.begin(), loop.end(), vertex);
  return found == loop.end() ? -1 : static_cast<Index>(found - loop.begin());
}

/// Throws unless the knots follow one another in the same order on both loops.
void require_one_turn(std::span<const Knot> knots, const PairGeometry& pair) {
  const auto& [source, target] = pair.loops;
  const auto target_size = static_cast<Index>(target.size());
  Index walked = 0;
  for (std::size_t m = 0; m < knots.size(); ++m) {
    const Knot& from = knots[m];
    const Knot& to = knots[(m + 1) % knots.size()];
    const Index step = ((from.target - to.target) % target_size + target_size) % target_size;
    if (knots.size() > 1 && step == 0)
      throw Error(
          facts::merge::TargetMatchedTwice{
              .source = source[from.source], .other_source = source[to.source], .target = target[to.target]},
          pair.location);
    walked += step;
    if (walked > target_size)
      throw Error(facts::merge::MatchesCross{.source = source[from.source],
                                             .next_source = source[to.source],
                                             .target = target[from.target],
                                             .next_target = target[to.target]},
                  pair.location);
  }
}

}  // namespace

std::vector<double> parameters_between(std::span<const Knot> knots, const LoopCurve& source,
                                       const LoopCurve& target) {
  std::vector<double> parameters(source.size());
  for (std::size_t m = 0; m < knots.size(); ++m) {
    const Knot& from = knots[m];
    const Knot& to = knots[(m + 1) % knots.size()];
    const double source_length = source.length_between(from.source, to.source);
    const double target_length = target.length_between(to.target, from.target);
    Index i = from.source;
    do {
      const double ahead = i == from.source ? 0 : source.length_between(from.source, i);
      parameters[i] =
          ahead == 0 ? from.target
                     : target.parameter_at(target.arc(from.target) - ahead / source_length * target_length);
      i = (i + 1) % source.size();
    } while (i != to.source);
  }
  return parameters;
}

Correspondence match_by_arc_length(const PairGeometry& pair, std::span<const Match> matches) {
  const auto& [source, target] = pair.loops;
  std::vector<Knot> knots;
  for (const Match& match : matches) {
    const Knot knot{index_in(source, match.source), index_in(target, match.target)};
    if (knot.source < 0 || knot.target < 0)
      throw Error(facts::merge::MatchNotOnLoop{.side = knot.source < 0 ? facts::merge::Side::source
                                                                       : facts::merge::Side::target,
                                               .vertex = knot.source < 0 ? match.source : match.target},
                  pair.location);
    knots.push_back(knot);
  }
  std::sort(knots.begin(), knots.end());
  knots.erase(std::unique(knots.begin(), knots.end()), knots.end());
  for (std::size_t m = 1; m < knots.size(); ++m)
    if (knots[m].source == knots[m - 1].source)
      throw Error(facts::merge::SourceMatchedTwice{.source = source[knots[m].source],
                                                   .target = target[knots[m - 1].target],
                                                   .other_target = target[knots[m].target]},
                  pair.location);
  require_one_turn(knots, pair);
  return {parameters_between(knots, LoopCurve(pair.source.points), LoopCurve(pair.target.points)), 1.0};
}

}  // namespace meshgraft
