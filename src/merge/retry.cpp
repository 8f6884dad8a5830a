#include "retry.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <ranges>
#include <set>
#include <utility>
#include <vector>

#include <meshgraft/core/error.h>

#include "loop_curve.h"
#include "start_candidates.h"

namespace meshgraft {

namespace {

/// Returns the numbers of further grafts for all vertices of both meshes and a number of pairs.
MostTries most_tries(Index vertices, std::size_t pairs) {
  // Chosen: 30 of each kind for one pair, and 12 for several. Meshes of 500,000 vertices and more get four, so
  // that a merge takes at most five times as long.
  constexpr int fewest = 4;
  constexpr Index vertices_of_all_tries = 2'000'000;
  const MostTries most = pairs == 1 ? MostTries{30, 30, 30} : MostTries{12, 0, 0};
  int left = std::clamp(vertices_of_all_tries / std::max<Index>(1, vertices), fewest, most.sum());
  const auto take = [&left](int tries) {
    const int taken = std::min(left, tries);
    left -= taken;
    return taken;
  };
  const int one_by_one = take(most.one_by_one), combined = take(most.combined);
  return {one_by_one, combined, left};
}

/// Returns how many of the first starts are as good as the first, because none is probable.
int equally_likely_starts(const Correspondence& found) {
  constexpr int most = 4;  // chosen
  if (!is_unsure(found.starts)) return 1;
  return std::min(most, static_cast<int>(found.starts.size()));
}

/// Returns element `number` of the van der Corput sequence in a base: its digits mirrored at the point.
double van_der_corput(int number, int base) {
  double value = 0, share = 1;
  for (; number > 0; number /= base) {
    share /= base;
    value += share * (number % base);
  }
  return value;
}

/// Returns a combination of values of all open settings. Those of the numbers 1, 2, … spread evenly over the
/// ranges (Halton 1960).
Variation combination(const OpenSettings& open, int number) {
  // Chosen: a sure start is kept but for a seventh of the loop, others may turn all the way.
  constexpr double largest_angle_deg = 60, smallest_size = 0.5, largest_size = 2;
  constexpr int most_doublings = 3;
  const double largest_shift = open.starts > 1 ? 0.5 : 0.15;
  const auto between = [number](int base, double low, double high) {
    return low + (high - low) * van_der_corput(number, base);
  };
  Variation variation;
  if (open.reach) variation.doublings = static_cast<int>(between(2, 0, most_doublings + 1));
  if (open.normal_angle) variation.normal_angle_deg = between(3, -largest_angle_deg, largest_angle_deg);
  if (open.size) variation.size_ratio = std::exp(between(5, std::log(smallest_size), std::log(largest_size)));
  if (open.start_shift) variation.start_shift = between(7, -largest_shift, largest_shift);
  return variation;
}

/// Returns a combination of values near those of a variation. Those of the numbers 1, 2, … spread evenly, as
/// those of `combination` do.
Variation beside(const Variation& best, const OpenSettings& open, int number) {
  // Chosen: at most the steps between the values that are tried one by one.
  constexpr double largest_angle_deg = 15, largest_size = 1.15, largest_shift = 0.04;
  const auto between = [number](int base, double bound) {
    return bound * (2 * van_der_corput(number, base) - 1);
  };
  Variation variation = best;
  if (open.normal_angle) variation.normal_angle_deg += between(3, largest_angle_deg);
  if (open.size) variation.size_ratio *= std::exp(between(5, std::log(largest_size)));
  if (open.start_shift) variation.start_shift += between(7, largest_shift);
  return variation;
}

/// Returns the correspondence from another start, moved along the target's loop by a share of its length.
Correspondence restarted(const PairGeometry& geometry, Correspondence found, int start, double shift) {
  if (start > 0) {
    const StartCandidate& other = found.starts[static_cast<std::size_t>(start)];
    found.start = other.start;
    found.confidence = other.probability;
  }
  const auto& loop = geometry.loops.target;
  const LoopCurve curve(geometry.target.points);
  const auto at = static_cast<Index>(std::find(loop.begin(), loop.end(), found.start.target) - loop.begin());
  const double parameter = curve.parameter_at(curve.arc(at) + shift * curve.length());
  found.start.target = loop[static_cast<std::size_t>(std::lround(parameter)) % loop.size()];
  return matched_again(geometry, {}, std::move(found));
}

}  // namespace

FoundVariation find_variation(const OpenSettings& open, double first, const MostTries& most,
                              const std::function<double(const Variation&)>& faults_of) {
  // The values and their order were measured on random grafts (docs/merging.md, "Random grafts"): the
  // influence radius is seen least and helps most often.
  constexpr int most_rounds = 3;
  FoundVariation found{.best = {}, .faults = first, .tries = 0};
  std::set<Variation> tried{found.best};
  int last_try = most.one_by_one;
  const auto attempt = [&](const Variation& variation) {
    if (found.faults == 0 || found.tries == last_try || !tried.insert(variation).second) return;
    ++found.tries;
    const double faults = faults_of(variation);
    if (faults >= found.faults) return;
    found.best = variation;
    found.faults = faults;
  };
  const auto attempt_values = [&](auto Variation::* setting, const auto& values) {
    for (const auto value : values) {
      Variation variation = found.best;
      variation.*setting = value;
      attempt(variation);
    }
  };
  constexpr std::array doublings{1, 2, 3};
  constexpr std::array angles_deg{20.0, -20.0, 40.0, -40.0, 60.0, -60.0};
  constexpr std::array size_ratios{0.8, 1.25, 0.65, 1.5};
  constexpr std::array shifts{0.04, -0.04, 0.08, -0.08, 0.15, -0.15};
  for (int round = 0; round < most_rounds; ++round) {
    const Variation before = found.best;
    if (open.reach) attempt_values(&Variation::doublings, doublings);
    if (open.normal_angle) attempt_values(&Variation::normal_angle_deg, angles_deg);
    if (open.size) attempt_values(&Variation::size_ratio, size_ratios);
    if (open.start_shift) attempt_values(&Variation::start_shift, shifts);
    attempt_values(&Variation::start, std::views::iota(1, std::max(1, open.starts)));
    if (found.best == before) break;
  }
  last_try = found.tries + most.combined;
  for (int number = 1; number <= most.combined; ++number) attempt(combination(open, number));
  last_try = found.tries + most.beside;
  for (int number = 1; number <= most.beside; ++number) attempt(beside(found.best, open, number));
  return found;
}

RetryReport retry_graft(const MatchedMeshes& matched, std::span<const MergePair> pairs,
                        const MergeOptions& options, const Context& context, MadeGraft& best) {
  const MostTries most =
      most_tries(matched.target.vertex_count() + matched.source.mesh.vertex_count(), pairs.size());
  const double found_size = best.grafted.found.shape.similarity.scale;
  const OpenSettings open{.reach = !options.reach.rings && !options.reach.length,
                          .normal_angle = options.normal_angle_deg == 0,
                          .size = !options.size && std::ranges::max(matched.component) == 0,
                          .start_shift = pairs.size() == 1 && pairs.front().matches.empty(),
                          .starts = equally_likely_starts(matched.correspondences.front())};
  RetryReport report{.faults_before = best.faults()};
  constexpr double impossible = std::numeric_limits<double>::infinity();
  const auto graft_again = [&](const Variation& variation, const Context& of_try) {
    MergeOptions varied = options;
    if (open.normal_angle) varied.normal_angle_deg = variation.normal_angle_deg;
    if (variation.size_ratio != 1) varied.size = variation.size_ratio * found_size;
    MadeGraft made{.correspondences = matched.correspondences};
    if (variation.start != 0 || variation.start_shift != 0)
      made.correspondences.front() = restarted(matched.geometry.front(), matched.correspondences.front(),
                                               variation.start, variation.start_shift);
    made.grafted = graft_source(matched, made.correspondences, varied, variation.doublings, of_try);
    if (made.grafted.found.doublings < variation.doublings) return impossible;
    const Index inverted = made.grafted.found.shape.inverted;
    best.fewest_inverted = made.fewest_inverted = std::min(best.fewest_inverted, inverted);
    if (inverted >= best.faults()) return impossible;
    made.seam = join_source(matched, made.grafted, varied, of_try);
    const Index faults = made.faults();
    if (faults < best.faults()) best = std::move(made);
    return static_cast<double>(faults);
  };
  int number = 0;
  const auto faults_of = [&](const Variation& variation) {
    try {
      return graft_again(variation, context.within("retry", ++number, most.sum()));
    } catch (const Error& error) {
      if (error.code() == ErrorCode::cancelled) throw;
      return impossible;
    }
  };
  const FoundVariation found = find_variation(open, best.faults(), most, faults_of);
  report.tries = found.tries;
  report.faults = best.faults();
  if (found.best == Variation{}) return report;
  report.reach_doublings = found.best.doublings;
  report.normal_angle_deg = found.best.normal_angle_deg;
  if (found.best.size_ratio != 1) report.size = found.best.size_ratio * found_size;
  report.start = found.best.start;
  report.start_shift = found.best.start_shift;
  return report;
}

}  // namespace meshgraft
