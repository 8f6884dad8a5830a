#include "open_hole.h"

#include <algorithm>
#include <cmath>
#include <functional>
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
#include "mesh/mesh_part.h"
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

/// Points of triangles near a source, three for each.
class NearTriangles {
 public:
  explicit NearTriangles(const Eigen::AlignedBox3d& box) : box_(box) {}

  /// Adds the triangles of a surface that are `chosen` (by index) and meet the box.
  void add(const PreparedTarget& surface, const std::function<bool(Eigen::Index)>& chosen) {
    for (Eigen::Index t = 0; t < surface.triangles.rows(); ++t) {
      Eigen::AlignedBox3d box;
      for (const Index v : surface.triangles.row(t)) box.extend(surface.mesh.positions.row(v).transpose());
      if (!box_.intersects(box) || !chosen(t)) continue;
      for (const Index v : surface.triangles.row(t)) points_.push_back(surface.mesh.positions.row(v));
    }
  }
  const std::vector<Vector>& points() const { return points_; }

 private:
  Eigen::AlignedBox3d box_;
  std::vector<Vector> points_;
};

/// Returns whether the undeformed source in this placement intersects the target outside the radius around
/// the source's loop.
bool cuts_through(const Mesh& source, const FlatLoop& loop, const SizeSearch& search, const FitResult& fit,
                  const Context& context) {
  const Eigen::Affine3d map = placement_map(loop, fit.placement, fit.size, boundary_centre(fit));
  const Points posed = (source.positions * map.linear().transpose()).rowwise() + map.translation().transpose();
  const Triangles triangles = triangulate(source, {.skip_out_of_range = true}).triangles;
  const double radius = loop.outline.width() / std::sqrt(std::numbers::pi);
  const std::vector<double> away = edge_distance(
      loop.vertices, source.positions, vertex_rings(source.vertex_count(), triangles), {.limit = radius});
  std::vector<Index> corners;
  Eigen::AlignedBox3d box;
  for (const auto& t : triangles.rowwise()) {
    if (std::any_of(t.begin(), t.end(), [&](Index v) { return std::isfinite(away[v]); })) continue;
    corners.insert(corners.end(), t.begin(), t.end());
    for (const Index v : t) box.extend(posed.row(v).transpose());
  }
  const std::vector<Index> free = corners;
  const auto of_source = static_cast<Index>(corners.size() / 3);

  NearTriangles near(box);
  const std::vector<Index>& in_part = fit.part->faces;
  near.add(search.target(), [&](Eigen::Index t) {
    return !std::binary_search(in_part.begin(), in_part.end(), search.target().face_of_triangle[t]);
  });
  const PreparedTarget& part = fit.chart->target;
  near.add(part, [&](Eigen::Index t) {
    const auto corners = part.triangles.row(t);
    return std::none_of(corners.begin(), corners.end(), [&](Index v) { return fit.footprint.is_inside(v); });
  });
  const auto of_target = static_cast<Eigen::Index>(near.points().size());
  Points points(posed.rows() + of_target, 3);
  points.topRows(posed.rows()) = posed;
  for (Eigen::Index k = 0; k < of_target; ++k) {
    points.row(posed.rows() + k) = near.points()[k];
    corners.push_back(static_cast<Index>(posed.rows() + k));
  }
  const auto pairs = self_intersections(
      points, Eigen::Map<const Triangles>(corners.data(), static_cast<Eigen::Index>(corners.size() / 3), 3),
      free, context);
  return std::any_of(pairs.begin(), pairs.end(),
                     [&](const TrianglePair& pair) { return pair[0] < of_source && pair[1] >= of_source; });
}

/// A target with a cut part.
struct CutTarget {
  Mesh mesh;
  IndexMap vertex;          ///< the target's vertices → `mesh`; -1 for those that were cut away
  std::vector<Index> loop;  ///< of the hole
};

/// Puts the part of a target back after it was cut. The vertices on the cut follow all others.
CutTarget put_back(const Mesh& target, const FitResult& fit, const CutResult& cut, const Context& context) {
  const std::vector<Index>& loop = cut.loops.front();
  const std::vector<Index>& in_target = fit.part->vertices;
  Replacement replacement{cut.mesh, std::vector<Index>(cut.origin.size(), -1), cut.face_parent};
  for (std::size_t v = 0; v < cut.origin.size(); ++v) {
    const auto& [from, to, t] = cut.origin[v];
    if (from == to && static_cast<std::size_t>(from) < in_target.size())
      replacement.vertex[v] = in_target[from];
  }
  for (const Index v : loop) replacement.vertex[v] = -1;
  for (Index& parent : replacement.face) parent = fit.face_parent[parent];
  ReplaceResult replaced = replace_part(target, *fit.part, replacement, context);
  const std::vector<Index>& new_index = replaced.replacement.new_index;
  for (std::size_t k = 0; k < in_target.size(); ++k)
    if (const Index v = cut.vertex.new_index[k]; v >= 0) replaced.whole.new_index[in_target[k]] = new_index[v];
  CutTarget result{std::move(replaced.mesh), std::move(replaced.whole), {}};
  for (const Index v : loop) result.loop.push_back(new_index[v]);
  return result;
}

/// Cuts out the inside of the outline. Returns the reason where this is not possible.
std::variant<OpenedHole, Note> cut_open(const Mesh& target, const FitResult& fit, const FlatLoop& loop,
                                        const Context& context) {
  constexpr double snap = 0.25;  // the ring around the hole is removed anyway
  const PlanePoints& uv = fit.footprint.uv;
  const CutResult cut = cut_at_zero(fit.chart->target.mesh, fit.footprint.values,
                                    {.keep = CutKeep::above, .snap = snap}, context);
  if (cut.loops.size() != 1) return Note(facts::merge::HoleNotDisc{.size = fit.size});
  std::vector<double> arcs;
  for (const Index v : cut.loops.front()) {
    const EdgePoint& origin = cut.origin[v];
    const Eigen::RowVector2d at = (1 - origin.t) * uv.row(origin.from) + origin.t * uv.row(origin.to);
    arcs.push_back(loop.outline.arc_of_nearest(at / fit.footprint.scale));
  }
  CutTarget cut_target = put_back(target, fit, cut, context);
  OpenedHole hole;
  hole.pair.matches = matches_along(loop.outline, loop.vertices, cut_target.loop, arcs);
  hole.pair.loops = {loop.vertices, std::move(cut_target.loop)};
  hole.vertex = std::move(cut_target.vertex);
  hole.target = std::move(cut_target.mesh);
  hole.size = fit.size;
  return hole;
}

constexpr int most_tries_to_clear = 4;

/// Returns advice for a source that reaches into the target.
Note advice_to_clear(const Mesh& source, const FlatLoop& loop, SizeSearch& search, double size,
                     const Context& context) {
  double other = size;
  for (int k = 0; k < most_tries_to_clear; ++k) {
    other *= next_size_ratio;
    const SizeTrial trial = search.at(other, true);
    if (trial.fit && !cuts_through(source, loop, search, *trial.fit, context))
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
  SizeSearch search(target, loop, drop, std::min(size, range.largest), context);
  Note why = facts::merge::LoopLargerThanTarget{.size = size};
  if (size <= range.largest) {
    const SizeTrial trial = search.at(size, true);
    if (trial.misfit) why = *trial.misfit;
    if (trial.fit) {
      auto opened = cut_open(target, *trial.fit, loop, context);
      if (auto* hole = std::get_if<OpenedHole>(&opened)) {
        hole->clear = !cuts_through(source, loop, search, *trial.fit, context);
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
  SizeSearch search(target, loop, drop, std::min(1.0, range.largest), context);
  Note why = facts::merge::LoopLargerThanTarget{.size = 1};
  const auto open = [&](const FitResult& fit, const Note& reason) -> std::optional<OpenedHole> {
    auto opened = cut_open(target, fit, loop, context);
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
    } else if (!cuts_through(source, loop, search, *trial.fit, context)) {
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
  return cut_open(target, *trial.fit, loop, context);
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
