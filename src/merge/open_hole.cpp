#include "open_hole.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <numbers>
#include <optional>
#include <utility>
#include <variant>

#include <Eigen/Geometry>

#include <meshgraft/core/error.h>
#include <meshgraft/deform/quality.h>
#include <meshgraft/mesh/cut.h>
#include <meshgraft/mesh/topology.h>

#include "drop_size.h"
#include "flat_loop.h"
#include "footprint.h"
#include "merge/facts.h"
#include "placement.h"
#include "prepared_target.h"

namespace meshgraft {

namespace {

using Vector = Eigen::RowVector3d;

/// Returns matched vertices of the two loops: for each section of the outline, the pair that is nearest along
/// the outline.
std::vector<Match> matches_along(const Outline& outline, const std::vector<Index>& source_loop,
                                 const std::vector<Index>& target_loop,
                                 const std::vector<double>& target_arcs) {
  constexpr Index most_stretches = 16, vertices_per_stretch = 3;
  const auto count = static_cast<Index>(source_loop.size()),
             target_count = static_cast<Index>(target_loop.size());
  const Index stretches =
      std::clamp(std::min(count, target_count) / vertices_per_stretch, Index{1}, most_stretches);
  struct Meeting {
    Index source = -1, target = -1;  // loop indices
    double apart = std::numeric_limits<double>::infinity();
  };
  std::vector<Meeting> best(stretches);
  for (Index i = 0; i < count; ++i) {
    const auto stretch = static_cast<std::size_t>(outline.arc(i) / outline.length() * stretches);
    for (Index j = 0; j < target_count; ++j) {
      const double way = std::abs(outline.arc(i) - target_arcs[j]);
      const double apart = std::min(way, outline.length() - way);
      if (apart < best[stretch].apart) best[stretch] = {i, j, apart};
    }
  }
  // The target's loop runs backwards. Matches that would cross an earlier one are left out.
  std::vector<Match> matches;
  Index turned_back = -1;
  std::optional<Index> first;
  for (const Meeting& meeting : best) {
    if (meeting.source < 0) continue;
    if (!first) first = meeting.target;
    const Index back = (*first - meeting.target + target_count) % target_count;
    if (back <= turned_back) continue;
    turned_back = back;
    matches.push_back({source_loop[meeting.source], target_loop[meeting.target]});
  }
  return matches;
}

/// Returns the drop's surface point, moved along the normal to the mean height of the hole's boundary.
Vector boundary_centre(const FitResult& fit) {
  const PreparedTarget& target = fit.chart->target;
  const Vector centre = fit.chart->point.point;
  double height = 0;
  Index count = 0;
  for (const Index v : fit.footprint.inside)
    for (const Index u : target.rings[v]) {
      if (fit.footprint.is_inside(u)) continue;
      const double s = fit.footprint.values[v] / (fit.footprint.values[v] - fit.footprint.values[u]);
      const Vector crossing = (1 - s) * target.mesh.positions.row(v) + s * target.mesh.positions.row(u);
      height += (crossing - centre).dot(fit.placement.normal);
      ++count;
    }
  return centre + height / static_cast<double>(count) * fit.placement.normal;
}

/// Returns whether the undeformed source in this placement intersects the target outside the radius around
/// the source's loop.
bool cuts_through(const Mesh& source, const FlatLoop& loop, const FitResult& fit, const Context& context) {
  const PreparedTarget& target = fit.chart->target;
  const Eigen::Affine3d map = placement_map(loop, fit.placement, fit.size, boundary_centre(fit));
  const Points posed = (source.positions * map.linear().transpose()).rowwise() + map.translation().transpose();
  const Triangles triangles = triangulate(source, {.skip_out_of_range = true}).triangles;
  const Index offset = target.mesh.vertex_count();
  std::vector<Index> corners;
  for (const auto& t : target.triangles.rowwise())
    if (std::none_of(t.begin(), t.end(), [&](Index v) { return fit.footprint.is_inside(v); }))
      corners.insert(corners.end(), t.begin(), t.end());
  const auto of_target = static_cast<Index>(corners.size() / 3);
  const double radius = loop.outline.width() / std::sqrt(std::numbers::pi);
  const std::vector<double> away = edge_distance(
      loop.vertices, source.positions, vertex_rings(source.vertex_count(), triangles), {.limit = radius});
  std::vector<Index> free;
  for (const auto& t : triangles.rowwise()) {
    if (std::any_of(t.begin(), t.end(), [&](Index v) { return std::isfinite(away[v]); })) continue;
    for (const Index v : t) {
      corners.push_back(offset + v);
      free.push_back(offset + v);
    }
  }
  Points points(offset + posed.rows(), 3);
  points << target.mesh.positions, posed;
  const auto pairs = self_intersections(
      points, Eigen::Map<const Triangles>(corners.data(), static_cast<Eigen::Index>(corners.size() / 3), 3),
      free, context);
  return std::any_of(pairs.begin(), pairs.end(),
                     [&](const TrianglePair& pair) { return pair[0] < of_target && pair[1] >= of_target; });
}

/// Cuts out the inside of the outline. Returns the reason where this is not possible.
std::variant<OpenedHole, Note> cut_open(const FitResult& fit, const FlatLoop& loop, Index target_vertices,
                                        const Context& context) {
  constexpr double snap = 0.25;  // the ring around the hole is removed anyway
  const PlanePoints& uv = fit.footprint.uv;
  CutResult cut = cut_at_zero(fit.chart->target.mesh, fit.footprint.values,
                              {.keep = CutKeep::above, .snap = snap}, context);
  if (cut.loops.size() != 1) return Note(facts::merge::HoleNotDisc{.size = fit.size});
  std::vector<double> arcs;
  for (const Index v : cut.loops.front()) {
    const EdgePoint& origin = cut.origin[v];
    const Eigen::RowVector2d at = (1 - origin.t) * uv.row(origin.from) + origin.t * uv.row(origin.to);
    arcs.push_back(loop.outline.arc_of_nearest(at / fit.footprint.scale));
  }
  OpenedHole hole;
  hole.pair = {{loop.vertices, cut.loops.front()},
               matches_along(loop.outline, loop.vertices, cut.loops.front(), arcs)};
  hole.vertex = std::move(cut.vertex);
  hole.vertex.new_index.resize(target_vertices);
  hole.target = std::move(cut.mesh);
  hole.size = fit.size;
  return hole;
}

constexpr int most_tries_to_clear = 4;

/// Returns advice for a source that reaches into the target.
Note advice_to_clear(const Mesh& source, const FlatLoop& loop, const SizeSearch& search, double size,
                     const Context& context) {
  double other = size;
  for (int k = 0; k < most_tries_to_clear; ++k) {
    other *= next_size_ratio;
    const SizeTrial trial = search.at(other, true);
    if (trial.fit && !cuts_through(source, loop, *trial.fit, context))
      return facts::merge::IntersectionAvoidedIfSmaller{.size = size, .smaller_size = other};
  }
  return facts::merge::SourceReachesIn{};
}

OpenedHole open_at_size(const Mesh& target, const Mesh& source, const FlatLoop& loop, const Drop& drop,
                        const Context& context) {
  const SizeRange range(target, loop);
  const double size = *drop.size;
  if (size < range.least)
    throw Error(facts::merge::SizeTooSmall{.size = size, .least = 1.1 * range.least}, "size");
  const SizeSearch search(target, loop, drop, std::min(size, range.largest), context);
  Note why = facts::merge::LoopLargerThanTarget{.size = size};
  if (size <= range.largest) {
    const SizeTrial trial = search.at(size, true);
    if (trial.misfit) why = *trial.misfit;
    if (trial.fit) {
      auto opened = cut_open(*trial.fit, loop, target.vertex_count(), context);
      if (auto* hole = std::get_if<OpenedHole>(&opened)) {
        hole->clear = !cuts_through(source, loop, *trial.fit, context);
        if (!hole->clear) hole->notes.push_back(advice_to_clear(source, loop, search, size, context));
        return std::move(*hole);
      }
      why = std::get<Note>(opened);
    }
  }
  const double fits = search.largest_below(std::min(size, range.largest), range.least);
  if (fits > 0) throw Error(facts::merge::NoHole{.size = size, .largest = fits}, "surface_point").with(why);
  throw Error(facts::merge::NoHoleAtAnySize{}, "surface_point").with(why);
}

/// Opens a hole in the source's own size, or in the largest smaller one that has room and keeps the source
/// clear of the target.
OpenedHole open_at_largest_size(const Mesh& target, const Mesh& source, const FlatLoop& loop, const Drop& drop,
                                const Context& context) {
  constexpr double least_width = 1e-3;  // × the target's diagonal
  const SizeRange range(target, loop);
  if (range.least > 1) throw Error(facts::merge::SourceTooSmall{.least = 1.1 * range.least}, "size");
  const double least = std::min(next_size_ratio, least_width * range.largest);
  const SizeSearch search(target, loop, drop, std::min(1.0, range.largest), context);
  Note why = facts::merge::LoopLargerThanTarget{.size = 1};
  const auto open = [&](const FitResult& fit, const Note& reason) -> std::optional<OpenedHole> {
    auto opened = cut_open(fit, loop, target.vertex_count(), context);
    if (auto* hole = std::get_if<OpenedHole>(&opened)) {
      if (fit.size < 1) hole->notes = {facts::merge::SourceScaled{.size = fit.size}, reason};
      return std::move(*hole);
    }
    why = std::get<Note>(opened);
    return std::nullopt;
  };
  std::shared_ptr<const FitResult> widest;  // largest one with room, though the source reaches in
  Note why_widest = why;
  int tries = 0;
  for (double size = 1; size >= least && tries < most_tries_to_clear; size *= next_size_ratio) {
    if (size > range.largest) continue;
    const SizeTrial trial = search.at(size, false);
    if (trial.misfit) {
      why = *trial.misfit;
    } else if (!cuts_through(source, loop, *trial.fit, context)) {
      if (auto hole = open(*trial.fit, why)) return *std::move(hole);
    } else {
      ++tries;
      if (!widest) {
        widest = trial.fit;
        why_widest = why;
      }
      why = facts::merge::SourceWouldReachIn{.size = size};
    }
  }
  if (widest) {
    if (auto hole = open(*widest, why_widest)) {
      hole->clear = false;
      hole->notes.push_back(facts::merge::SourceReachesIn{});
      return *std::move(hole);
    }
  }
  throw Error(facts::merge::NoHoleAtAnySize{}, "surface_point").with(why);
}

}  // namespace

void require_inner_point(const Mesh& target, const Drop& drop) {
  const auto* vertex = std::get_if<Index>(&drop.surface_point);
  if (vertex == nullptr) return;
  for (const auto& loop : boundary_loops(target))
    if (std::find(loop.begin(), loop.end(), *vertex) != loop.end())
      throw Error(facts::merge::VertexOnBoundary{.vertex = *vertex}, "surface_point");
}

std::variant<OpenedHole, Note> open_hole_for_loop(const Mesh& target, const FlatLoop& loop, const Drop& drop,
                                                  const Context& context) {
  const double size = drop.size.value_or(1);
  const SizeRange range(target, loop);
  if (size > range.largest) return Note(facts::merge::LoopLargerThanTarget{.size = size});
  const SizeTrial trial = SizeSearch(target, loop, drop, size, context).at(size, true);
  if (trial.misfit) return *trial.misfit;
  return cut_open(*trial.fit, loop, target.vertex_count(), context);
}

struct DropGuide::Prepared {
  PreparedTarget target;
  FlatLoop loop;
};

DropGuide::DropGuide(std::shared_ptr<const Mesh> target, const Mesh& source,
                     const std::vector<std::vector<Index>>& source_loops, const Context& context) {
  std::vector<FlatLoop> loops;
  for (const auto& listed : source_loops) loops.push_back(flatten_loop(*target, source, listed));
  FlatLoop loop = loops.size() == 1 ? loops.front() : hull_of_loops(source.positions, loops);
  prepared_ = std::make_shared<const Prepared>(PreparedTarget(std::move(target), context), std::move(loop));
}

Eigen::Affine3d DropGuide::pose(const Drop& drop) const {
  const auto& [target, loop] = *prepared_;
  validate(drop, target.mesh);
  const SurfacePoint point = find_surface_point(target, drop);
  const double size = drop.size.value_or(1);
  return placement_map(loop, place_outline(target, point, loop, size, drop.spin_deg), size, point.point);
}

OpenedHole open_hole(const Mesh& target, const Mesh& source, const Drop& drop, const Context& context) {
  context.step("open");
  validate(drop, target);
  require_inner_point(target, drop);
  const FlatLoop flat = flatten_loop(target, source, drop.source_loop);
  OpenedHole hole = drop.size ? open_at_size(target, source, flat, drop, context)
                              : open_at_largest_size(target, source, flat, drop, context);
  if (flat.smoothed) hole.notes.push_back(facts::merge::LoopRoundedOff{});
  return hole;
}

}  // namespace meshgraft
