#include "drop_size.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include <fmt/format.h>

#include "merge/facts.h"
#include "mesh/box_diagonal.h"

namespace meshgraft {

namespace {

constexpr double roomy = 0.85;  // chosen, × the outline's width: a hole at least this wide is flat enough

double rounded_to_three_digits(double size) { return std::stod(fmt::format("{:.3g}", size)); }

}  // namespace

SizeRange::SizeRange(const Mesh& target, const FlatLoop& loop) {
  constexpr double least_width = 1e-6;  // × the target's diagonal
  largest = box_diagonal(target.positions) / loop.outline.width();
  least = least_width * largest;
}

SizeSearch::SizeSearch(const Mesh& target, const FlatLoop& loop, const Drop& drop, double largest,
                       const Context& context)
    : loop_(loop),
      drop_(drop),
      context_(context),
      chart_(make_chart(std::shared_ptr<const Mesh>(&target, [](const Mesh*) {}), drop, chart_radius(largest),
                        context)) {}

SizeTrial SizeSearch::at(double size, bool may_widen) const {
  constexpr int most_halvings = 12;
  constexpr double edge_ratio = 2, fewest_edges = 24;
  const double longest = size * loop_.outline.length() /
                         std::max(fewest_edges, static_cast<double>(loop_.outline.size()) / edge_ratio);
  const Placement placement = place_outline(chart_->target, chart_->point, loop_, size, drop_.spin_deg);
  FitResult fit{chart_, lay_outline(*chart_, loop_.outline, size, placement), placement, size};
  for (int halving = 0; halving < most_halvings; ++halving) {
    const auto refined = refine_around(fit.chart->target.mesh, fit.footprint, longest, context_);
    if (!refined) break;
    fit.chart = make_chart(refined, drop_, chart_radius(size), context_);
    fit.footprint = lay_outline(*fit.chart, loop_.outline, size, fit.placement);
  }
  if (std::optional<Note> obstacle = find_obstacle(fit.chart->target, fit.footprint, size))
    return {nullptr, std::move(obstacle)};
  const double width = width_of(fit.chart->target, fit.footprint) / loop_.outline.width();
  if (width < roomy * (may_widen ? size : fit.footprint.scale))
    return {nullptr, facts::merge::SurfaceTooNarrow{.size = size}};
  return {std::make_shared<const FitResult>(std::move(fit)), {}};
}

double SizeSearch::largest_below(double size, double least) const {
  constexpr int bisections = 3;
  const auto fits = [&](double s) { return at(s, true).fit != nullptr; };
  double too_large = size, fitting = rounded_to_three_digits(size * next_size_ratio);
  for (; !fits(fitting); fitting = rounded_to_three_digits(fitting * next_size_ratio)) {
    if (fitting < least) return 0;
    too_large = fitting;
  }
  for (int k = 0; k < bisections; ++k) {
    const double middle = rounded_to_three_digits(std::sqrt(fitting * too_large));
    (fits(middle) ? fitting : too_large) = middle;
  }
  return fitting;
}

}  // namespace meshgraft
