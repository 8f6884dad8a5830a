#include "drop_size.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>
#include <variant>

#include <fmt/format.h>

#include "merge/facts.h"
#include "mesh/box_diagonal.h"

namespace meshgraft {

namespace {

constexpr double roomy = 0.85;  // chosen, × the outline's width: a hole at least this wide is flat enough

double rounded_to_three_digits(double size) { return std::stod(fmt::format("{:.3g}", size)); }

Chart chart_of_whole(const Mesh& target, const Drop& drop, double radius, const Context& context) {
  PreparedTarget whole(std::shared_ptr<const Mesh>(&target, [](const Mesh*) {}), context);
  SurfacePoint point = find_surface_point(whole, drop);
  return make_chart(std::move(whole), std::move(point), radius, context);
}

}  // namespace

SizeRange::SizeRange(const Mesh& target, const FlatLoop& loop) {
  constexpr double least_width = 1e-6;  // × the target's diagonal
  largest = box_diagonal(target.positions) / loop.outline.width();
  least = least_width * largest;
}

SizeSearch::SizeSearch(const Mesh& target, const FlatLoop& loop, const Drop& drop, double largest,
                       const Context& context)
    : target_(target),
      loop_(loop),
      drop_(drop),
      context_(context),
      largest_(largest),
      whole_(chart_of_whole(target, drop, chart_radius(largest), context)) {
  for (Index v = 0; v < target.vertex_count(); ++v)
    if (whole_.uv.row(v).allFinite()) charted_.push_back(v);
  take_part();
}

/// Takes the part of the target within `margin_` rings of the charted vertices.
void SizeSearch::take_part() {
  Flags is_inner(target_.vertex_count(), false);
  for (const Index v : grow_rings(charted_, margin_, whole_.target.rings)) is_inner[v] = true;
  const auto exists = [&](Index v) { return v >= 0 && v < target_.vertex_count(); };
  std::vector<Index> faces;
  for (Index f = 0; f < target_.face_count(); ++f) {
    const auto face = target_.faces[f];
    if (std::all_of(face.begin(), face.end(), exists) &&
        std::any_of(face.begin(), face.end(), [&](Index v) { return is_inner[v]; }))
      faces.push_back(f);
  }
  part_ = std::make_shared<const MeshPart>(part_of(target_, std::move(faces)));
  at_rim_.clear();
  for (const Index v : part_->vertices) at_rim_.push_back(!is_inner[v]);
  drop_on_part_ = drop_;
  if (auto* vertex = std::get_if<Index>(&drop_on_part_.surface_point))
    *vertex = static_cast<Index>(std::lower_bound(part_->vertices.begin(), part_->vertices.end(), *vertex) -
                                 part_->vertices.begin());
  chart_ = chart_of(std::shared_ptr<const Mesh>(part_, &part_->mesh), largest_);
}

/// Makes the chart of the part, or of the part with halved edges.
std::shared_ptr<const Chart> SizeSearch::chart_of(std::shared_ptr<const Mesh> part, double size) const {
  PreparedTarget prepared(std::move(part), context_);
  SurfacePoint point = locate(prepared, drop_on_part_);
  return std::make_shared<const Chart>(
      make_chart(std::move(prepared), std::move(point), chart_radius(size), context_));
}

/// Returns whether a chart reaches the part's rim, where edges must stay as they are. Halved edges make charts
/// reach a little farther.
bool SizeSearch::reaches_rim(const Chart& chart) const {
  for (std::size_t v = 0; v < at_rim_.size(); ++v)
    if (at_rim_[v] && chart.uv.row(static_cast<Eigen::Index>(v)).allFinite()) return true;
  return false;
}

/// Returns the index of a chart's vertex in the target, with the same edges halved there.
Index SizeSearch::index_in_target(Index vertex) const {
  const auto count = static_cast<Index>(part_->vertices.size());
  return vertex < count ? part_->vertices[vertex] : target_.vertex_count() + vertex - count;
}

/// Lays the outline on the part, with edges around it halved down to `longest`. Returns nothing where the part
/// is too small for that.
std::optional<FitResult> SizeSearch::lay(double size, double longest) const {
  constexpr int most_halvings = 12;
  const Placement placement = place_outline(chart_->target, chart_->point, loop_, size, drop_.spin_deg);
  FitResult fit{part_,     chart_, part_->faces, lay_outline(*chart_, loop_.outline, size, placement),
                placement, size};
  for (int halving = 0; halving < most_halvings; ++halving) {
    auto refined = refine_around(fit.chart->target.mesh, fit.footprint, longest, context_);
    if (!refined) break;
    for (Index& parent : refined->face_parent) parent = fit.face_parent[parent];
    fit.face_parent = std::move(refined->face_parent);
    fit.chart = chart_of(std::make_shared<const Mesh>(std::move(refined->mesh)), size);
    if (reaches_rim(*fit.chart)) return std::nullopt;
    fit.footprint = lay_outline(*fit.chart, loop_.outline, size, fit.placement);
  }
  return fit;
}

SizeTrial SizeSearch::at(double size, bool may_widen) {
  constexpr double edge_ratio = 2, fewest_edges = 24;
  const double longest = size * loop_.outline.length() /
                         std::max(fewest_edges, static_cast<double>(loop_.outline.size()) / edge_ratio);
  std::optional<FitResult> laid;
  while (!(laid = lay(size, longest))) {
    margin_ *= 4;
    take_part();
  }
  FitResult& fit = *laid;
  if (std::optional<Note> obstacle =
          find_obstacle(fit.chart->target, fit.footprint, size, [&](Index v) { return index_in_target(v); }))
    return {nullptr, std::move(obstacle)};
  const double width = width_of(fit.chart->target, fit.footprint) / loop_.outline.width();
  if (width < roomy * (may_widen ? size : fit.footprint.scale))
    return {nullptr, facts::merge::SurfaceTooNarrow{.size = size}};
  return {std::make_shared<const FitResult>(std::move(fit)), {}};
}

double SizeSearch::largest_below(double size, double least) {
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
