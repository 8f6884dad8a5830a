#include <meshgraft/merge/open_hole.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <span>
#include <utility>

#include <fmt/format.h>
#include <Eigen/Geometry>

#include <meshgraft/core/error.h>
#include <meshgraft/mesh/cut.h>
#include <meshgraft/mesh/normals.h>
#include <meshgraft/mesh/refine.h>
#include <meshgraft/mesh/topology.h>

#include "../mesh/edge_table.h"
#include "exponential_map.h"
#include "loop_curve.h"
#include "loops.h"
#include "outline.h"

namespace meshgraft {

namespace {

using Vector = Eigen::RowVector3d;

constexpr double most_widened = 1.5;  // × the loop's own width
constexpr double roomy = 0.85;        // a hole of this width × the outline's is flat enough for it

void validate(const Drop& drop, const Mesh& target) {
  if (drop.size && !(*drop.size > 0 && *drop.size < 1e100))
    throw Error(ErrorCode::input, fmt::format("{} is not a positive number", *drop.size), "size");
  if (!std::isfinite(drop.spin_deg)) throw Error(ErrorCode::input, "the angle is not finite", "spin_deg");
  if (const auto* point = std::get_if<Eigen::Vector3d>(&drop.place); point != nullptr && !point->allFinite())
    throw Error(ErrorCode::input, "the point is not finite", "place");
  const auto* vertex = std::get_if<Index>(&drop.place);
  if (vertex != nullptr && (*vertex < 0 || *vertex >= target.vertex_count()))
    throw Error(ErrorCode::input,
                fmt::format("target vertex {} does not exist; the mesh has {}", *vertex, target.vertex_count()),
                "place", "Name another vertex, or a point");
}

/// A source's loop, flattened: `axis` points to where the source is.
struct FlatLoop {
  std::vector<Index> vertices;
  Vector axis, first_axis;
  Outline outline;
  bool smoothed = false;
};

/// Moves a polygon's centre of area to the origin.
void centre(PlanePoints& polygon) {
  Eigen::RowVector2d sum = Eigen::RowVector2d::Zero();
  polygon.rowwise() -= Eigen::RowVector2d(polygon.colwise().mean());
  for (Eigen::Index i = 0; i < polygon.rows(); ++i) {
    const Eigen::RowVector2d a = polygon.row(i), b = polygon.row((i + 1) % polygon.rows());
    sum += (a.x() * b.y() - a.y() * b.x()) * (a + b) / 3;
  }
  polygon.rowwise() -= Eigen::RowVector2d(sum / double_area(polygon));
}

/// Rounds a polygon off until it does not cross itself, and gives it its width back.
bool smooth_until_simple(PlanePoints& polygon) {
  constexpr int most_passes = 400, passes_at_once = 8;
  const double width = Outline(polygon).width();
  const Eigen::Index count = polygon.rows();
  for (int pass = 0; pass < most_passes; ++pass) {
    if (pass % passes_at_once == 0 && is_simple(polygon)) {
      polygon *= width / Outline(polygon).width();
      return true;
    }
    PlanePoints next = polygon;
    for (Eigen::Index i = 0; i < count; ++i)
      next.row(i) =
          (polygon.row((i + count - 1) % count) + 2 * polygon.row(i) + polygon.row((i + 1) % count)) / 4;
    polygon = std::move(next);
  }
  return false;
}

FlatLoop flatten(const Mesh& source, std::vector<Index> loop) {
  constexpr double least_area = 0.02;  // × that of a circle of the loop's length
  Points points(static_cast<Eigen::Index>(loop.size()), 3);
  for (std::size_t i = 0; i < loop.size(); ++i)
    points.row(static_cast<Eigen::Index>(i)) = source.positions.row(loop[i]);
  const Vector axis = loop_axis(points), first = axis.transpose().unitOrthogonal().transpose();
  Eigen::Matrix<double, 3, 2> axes;
  axes << first.transpose(), axis.transpose().cross(first.transpose());
  PlanePoints polygon = (points.rowwise() - Vector(points.colwise().mean())) * axes;
  const double length = LoopCurve(points).length();
  if (!(2 * std::numbers::pi * double_area(polygon) > least_area * length * length))
    throw Error(ErrorCode::input, fmt::format("the source's loop at vertex {} spans no area", loop.front()), "",
                "Cut the source where the loop is open like a ring");
  const bool simple = is_simple(polygon);
  if (!simple && !smooth_until_simple(polygon))
    throw Error(
        ErrorCode::input,
        fmt::format("the source's loop at vertex {} crosses itself as seen along its axis", loop.front()), "",
        "Cut the source again, along a simpler curve");
  centre(polygon);
  return {std::move(loop), axis, first, Outline(std::move(polygon)), !simple};
}

/// The target with what is asked of it again and again.
struct Surface {
  explicit Surface(const Mesh& mesh_, const Context& context)
      : mesh(mesh_),
        triangles(triangulate(mesh, {.skip_out_of_range = true}).triangles),
        rings(vertex_rings(mesh.vertex_count(), triangles, context)),
        normals(vertex_normals(mesh)) {}

  const Mesh& mesh;
  Triangles triangles;
  IndexLists rings;
  Points normals;
};

/// A point of a surface, with the vertex there or the corners of the triangle around it.
struct SurfacePoint {
  Vector point;
  std::vector<Index> corners;
};

/// The point of a triangle nearest to another one.
Vector nearest_in_triangle(const Vector& p, const Vector& a, const Vector& b, const Vector& c) {
  const Vector ab = b - a, ac = c - a, normal = ab.transpose().cross(ac.transpose()).transpose();
  const double square = normal.squaredNorm();
  if (square > 0) {
    const double v = (p - a).transpose().cross(ac.transpose()).dot(normal.transpose()) / square;
    const double w = ab.transpose().cross((p - a).transpose()).dot(normal.transpose()) / square;
    if (v >= 0 && w >= 0 && v + w <= 1) return a + v * ab + w * ac;
  }
  Vector best = a;
  for (const auto& [from, to] : {std::pair{a, b}, std::pair{b, c}, std::pair{c, a}}) {
    const Vector edge = to - from;
    const double length = edge.squaredNorm();
    const double t = length > 0 ? std::clamp((p - from).dot(edge) / length, 0.0, 1.0) : 0.0;
    const Vector q = from + t * edge;
    if ((p - q).squaredNorm() < (p - best).squaredNorm()) best = q;
  }
  return best;
}

SurfacePoint nearest_on(const Surface& surface, const Vector& point) {
  const Points& x = surface.mesh.positions;
  double least = std::numeric_limits<double>::infinity();
  SurfacePoint best{point, {}};
  for (Eigen::Index t = 0; t < surface.triangles.rows(); ++t) {
    const auto corners = surface.triangles.row(t);
    const Vector q = nearest_in_triangle(point, x.row(corners[0]), x.row(corners[1]), x.row(corners[2]));
    const double distance = (q - point).norm();
    if (!(distance < least)) continue;
    least = distance;
    best = {q, {corners[0], corners[1], corners[2]}};
  }
  return best;
}

SurfacePoint place_on(const Surface& surface, const Drop& drop) {
  constexpr double near_surface = 0.05;  // × the target's diagonal
  if (const auto* vertex = std::get_if<Index>(&drop.place)) {
    if (surface.rings[*vertex].empty())
      throw Error(ErrorCode::input, fmt::format("target vertex {} belongs to no face", *vertex), "place",
                  "Name another vertex, or a point");
    return {surface.mesh.positions.row(*vertex), {*vertex}};
  }
  const Vector point = std::get<Eigen::Vector3d>(drop.place).transpose();
  if (surface.triangles.rows() == 0) throw Error(ErrorCode::input, "the target has no faces");
  SurfacePoint found = nearest_on(surface, point);
  const Points& x = surface.mesh.positions;
  const double diagonal = (x.colwise().maxCoeff() - x.colwise().minCoeff()).norm();
  const double distance = (found.point - point).norm();
  if (!(distance <= near_surface * diagonal))
    throw Error(ErrorCode::input,
                fmt::format("the point ({:.6g}, {:.6g}, {:.6g}) is {:.4g} away from the target's surface",
                            point.x(), point.y(), point.z(), distance),
                "place",
                fmt::format("Name a point near it; the nearest one is {:.6g},{:.6g},{:.6g}", found.point.x(),
                            found.point.y(), found.point.z()));
  return found;
}

/// The normal around a place, averaged over a distance along the surface.
Vector mean_normal(const Surface& surface, const SurfacePoint& place, double distance) {
  constexpr double wrapped = 0.3;
  const Points& x = surface.mesh.positions;
  const std::vector<double> away = edge_distance(place.corners, x, surface.rings, distance);
  Vector sum = Vector::Zero(), local = Vector::Zero();
  double area = 0;
  for (Eigen::Index t = 0; t < surface.triangles.rows(); ++t) {
    const auto corners = surface.triangles.row(t);
    if (std::none_of(corners.begin(), corners.end(), [&](Index v) { return std::isfinite(away[v]); })) continue;
    const Vector ab = x.row(corners[1]) - x.row(corners[0]), ac = x.row(corners[2]) - x.row(corners[0]);
    const Vector normal = ab.transpose().cross(ac.transpose()).transpose();
    sum += normal;
    area += normal.norm();
  }
  for (const Index v : place.corners) local += surface.normals.row(v);
  return (sum.norm() > wrapped * area ? sum : local).stableNormalized();
}

Vector turned(const Vector& vector, const Vector& from, const Vector& to) {
  return Eigen::Quaterniond::FromTwoVectors(from.transpose(), to.transpose()) * vector.transpose();
}

/// The outline's first axis, laid on the plane with this normal: turned there the shortest way, then spun.
Vector laid_axis(const FlatLoop& loop, const Vector& normal, double spin_deg) {
  const Eigen::AngleAxisd spin(spin_deg * std::numbers::pi / 180, normal.transpose());
  return spin * turned(loop.first_axis, loop.axis, normal).transpose();
}

/// Why a hole cannot be opened.
struct Misfit {
  std::string what;
};

/// The outline on a surface: negative values at the vertices within.
struct Drawing {
  std::vector<double> values;
  std::vector<Index> inside;
  double scale = 0;  ///< of the outline

  bool is_inside(Index v) const { return values[v] < 0; }
};

/// The vertices within the outline that hang together with the deepest one.
std::vector<Index> connected_inside(const std::vector<double>& values, const IndexLists& rings) {
  const auto deepest = std::min_element(values.begin(), values.end());
  if (deepest == values.end() || *deepest >= 0) return {};
  std::vector<Index> inside{static_cast<Index>(deepest - values.begin())};
  std::vector<bool> seen(values.size(), false);
  seen[inside.front()] = true;
  for (std::size_t k = 0; k < inside.size(); ++k)
    for (const Index v : rings[inside[k]]) {
      if (seen[v] || values[v] >= 0) continue;
      seen[v] = true;
      inside.push_back(v);
    }
  return inside;
}

Drawing draw(const Outline& outline, double scale, const PlanePoints& places, const IndexLists& rings) {
  std::vector<double> values(static_cast<std::size_t>(places.rows()), scale * outline.reach());
  for (Eigen::Index v = 0; v < places.rows(); ++v)
    if (places.row(v).allFinite())
      values[static_cast<std::size_t>(v)] = scale * outline.signed_distance(places.row(v) / scale);
  Drawing drawing{values, connected_inside(values, rings), scale};
  for (double& value : drawing.values) value = std::abs(value);
  for (const Index v : drawing.inside) drawing.values[v] = values[v];
  return drawing;
}

/// How wide the drawn curve is: the root of the area that it spans, seen from where it is largest.
double drawn_width(const Surface& surface, const Drawing& drawing) {
  Eigen::Vector3d double_area = Eigen::Vector3d::Zero();
  const Vector origin = surface.mesh.positions.row(drawing.inside.front());
  for (Eigen::Index t = 0; t < surface.triangles.rows(); ++t) {
    Eigen::Vector3d out = Eigen::Vector3d::Zero(), in = Eigen::Vector3d::Zero();
    for (int c = 0; c < 3; ++c) {
      const Index a = surface.triangles(t, c), b = surface.triangles(t, (c + 1) % 3);
      if (drawing.is_inside(a) == drawing.is_inside(b)) continue;
      const double s = drawing.values[a] / (drawing.values[a] - drawing.values[b]);
      (drawing.is_inside(a) ? out : in) =
          ((1 - s) * surface.mesh.positions.row(a) + s * surface.mesh.positions.row(b) - origin).transpose();
    }
    double_area += in.cross(out);
  }
  return std::sqrt(double_area.norm() / 2);
}

/// Draws the outline as wide as it is, by widening it where the surface curves away under it.
Drawing draw_as_wide(const Surface& surface, const Outline& outline, double size, const PlanePoints& places) {
  constexpr int steps = 4;
  double widened = 1;
  for (int step = 0;; ++step) {
    Drawing drawing = draw(outline, size * widened, places, surface.rings);
    if (step == steps || drawing.inside.empty()) return drawing;
    const double ratio = drawn_width(surface, drawing) / (size * outline.width());
    widened = std::clamp(widened / std::max(ratio, 0.1), 1 / most_widened, most_widened);
  }
}

/// The mesh with edges around the outline halved that are too long to draw it; false where there are none.
bool refine_around(Mesh& mesh, const Drawing& drawing, const PlanePoints& places, double longest,
                   const Context& context) {
  bool any = false;
  const auto is_long = [&](Index a, Index b) {
    if (!places.row(a).allFinite() || !places.row(b).allFinite()) return false;
    const double length = (mesh.positions.row(a) - mesh.positions.row(b)).norm();
    const bool chosen =
        length > longest && std::min(std::abs(drawing.values[a]), std::abs(drawing.values[b])) <= length;
    any = any || chosen;
    return chosen;
  };
  RefineResult refined = split_edges(mesh, is_long, context);
  if (any) mesh = std::move(refined.mesh);
  return any;
}

/// What keeps the part of the surface within the outline from being cut away.
std::optional<Misfit> find_obstacle(const Surface& surface, const Drawing& drawing) {
  if (drawing.inside.empty()) return Misfit{"the loop is too small for the target's faces"};
  std::vector<Index> around;
  bool crossed = false;
  for (Eigen::Index t = 0; t < surface.triangles.rows(); ++t) {
    const auto corners = surface.triangles.row(t);
    const auto count =
        std::count_if(corners.begin(), corners.end(), [&](Index v) { return drawing.is_inside(v); });
    if (count > 0) around.insert(around.end(), corners.begin(), corners.end());
    crossed = crossed || (count > 0 && count < 3);
  }
  if (!crossed) return Misfit{"the loop is larger than the surface there"};
  const Eigen::Map<const Triangles> star(around.data(), static_cast<Eigen::Index>(around.size()) / 3, 3);
  const Mesh patch = make_mesh(surface.mesh.positions, star);
  const EdgeTable table(patch.vertex_count(), patch.faces);
  for (Index e = 0; e < table.edge_count(); ++e) {
    const auto& [a, b] = table.ends[e];
    if (!drawing.is_inside(a) && !drawing.is_inside(b)) continue;
    const auto along = table.half_edges[e];
    const auto tail = [&](std::size_t k) { return patch.faces.corners()[along[k]]; };
    if (along.size() > 2 || (along.size() == 2 && tail(0) == tail(1)))
      return Misfit{fmt::format("the target is not an oriented manifold within the hole, at edge {}–{}", a, b)};
  }
  for (const std::vector<Index>& loop : boundary_loops(patch))
    for (const Index v : loop)
      if (drawing.is_inside(v)) return Misfit{fmt::format("the hole would reach the boundary at vertex {}", v)};
  return std::nullopt;
}

/// Vertices of the two loops that meet: of each stretch of the outline those that are nearest along it.
std::vector<Match> matches_along(const Outline& outline, const std::vector<Index>& source_loop,
                                 const std::vector<Index>& target_loop,
                                 const std::vector<double>& target_arcs) {
  constexpr Index most_stretches = 16, vertices_per_stretch = 3;
  const auto count = static_cast<Index>(source_loop.size()),
             target_count = static_cast<Index>(target_loop.size());
  const Index stretches =
      std::clamp(std::min(count, target_count) / vertices_per_stretch, Index{1}, most_stretches);
  struct Place {
    Index source = -1, target = -1;  // places in the loops
    double apart = std::numeric_limits<double>::infinity();
  };
  std::vector<Place> best(static_cast<std::size_t>(stretches));
  for (Index i = 0; i < count; ++i) {
    const auto stretch = static_cast<std::size_t>(outline.arc(i) / outline.length() * stretches);
    for (Index j = 0; j < target_count; ++j) {
      const double way = std::abs(outline.arc(i) - target_arcs[static_cast<std::size_t>(j)]);
      const double apart = std::min(way, outline.length() - way);
      if (apart < best[stretch].apart) best[stretch] = {i, j, apart};
    }
  }
  // The target's loop runs backwards; what would cross the matches before it is left out.
  std::vector<Match> matches;
  Index turned_back = -1;
  std::optional<Index> first;
  for (const Place& place : best) {
    if (place.source < 0) continue;
    if (!first) first = place.target;
    const Index back = (*first - place.target + target_count) % target_count;
    if (back <= turned_back) continue;
    turned_back = back;
    matches.push_back({source_loop[static_cast<std::size_t>(place.source)],
                       target_loop[static_cast<std::size_t>(place.target)]});
  }
  return matches;
}

struct Opening {
  OpenedHole hole;
  double width_rel = 1;  ///< of the hole, × the loop's
  double flatness = 1;   ///< of the hole, × the outline as it was drawn: less where the surface curves away
};

/// Cuts the outline's inside away.
std::variant<Opening, Misfit> cut_open(const Surface& surface, const Drawing& drawing, const FlatLoop& loop,
                                       const PlanePoints& places, const Context& context) {
  constexpr double snap = 0.25;  // the ring around the hole goes anyway
  CutResult cut = cut_at_zero(surface.mesh, drawing.values, {.keep = CutKeep::above, .snap = snap}, context);
  const Index removed =
      summarise_topology(surface.mesh).euler_characteristic - summarise_topology(cut.mesh).euler_characteristic;
  if (cut.loops.size() != 1 || removed != 1)
    return Misfit{"the loop reaches round the surface there, so that what it encloses is no disc"};
  std::vector<double> arcs;
  for (const Index v : cut.loops.front()) {
    const Between& origin = cut.origin[static_cast<std::size_t>(v)];
    const Eigen::RowVector2d place =
        (1 - origin.t) * places.row(origin.from) + origin.t * places.row(origin.to);
    arcs.push_back(loop.outline.arc_of_nearest(place / drawing.scale));
  }
  Opening opening;
  opening.hole.pair = {{loop.vertices, cut.loops.front()},
                       matches_along(loop.outline, loop.vertices, cut.loops.front(), arcs)};
  opening.hole.vertex = std::move(cut.vertex);
  opening.hole.target = std::move(cut.mesh);
  return opening;
}

std::variant<Opening, Misfit> open_at_size(const Mesh& target, const FlatLoop& loop, double size,
                                           const Drop& drop, const Context& context) {
  constexpr int most_halvings = 12;
  constexpr double edge_ratio = 2, fewest_edges = 24;
  const double longest = size * loop.outline.length() /
                         std::max(fewest_edges, static_cast<double>(loop.outline.size()) / edge_ratio);
  const double reach = most_widened * size * loop.outline.reach();
  Mesh mesh = target;
  std::optional<Vector> normal;
  for (int halving = 0;; ++halving) {
    const Surface surface(mesh, context);
    const SurfacePoint place = place_on(surface, drop);
    if (!normal) normal = mean_normal(surface, place, size * loop.outline.reach());
    Vector local = Vector::Zero();
    for (const Index v : place.corners) local += surface.normals.row(v);
    local = local.norm() > 0 ? Vector(local.normalized()) : *normal;
    const Vector axis = turned(laid_axis(loop, *normal, drop.spin_deg), *normal, local);
    const PlanePoints places = exponential_map(mesh.positions, surface.normals, surface.rings,
                                               {place.point, local, axis, place.corners}, reach, context);
    const Drawing drawing = draw_as_wide(surface, loop.outline, size, places);
    if (halving < most_halvings && refine_around(mesh, drawing, places, longest, context)) continue;
    if (std::optional<Misfit> obstacle = find_obstacle(surface, drawing)) return *std::move(obstacle);
    auto result = cut_open(surface, drawing, loop, places, context);
    if (auto* opening = std::get_if<Opening>(&result)) {
      const double width = drawn_width(surface, drawing) / loop.outline.width();
      opening->width_rel = width / size;
      opening->flatness = width / drawing.scale;
      opening->hole.vertex.new_index.resize(static_cast<std::size_t>(target.vertex_count()));
      opening->hole.size = size;
    }
    return result;
  }
}

}  // namespace

OpenedHole open_hole(const Mesh& target, const Mesh& source, const std::vector<Index>& source_loop,
                     const Drop& drop, const Context& context) {
  constexpr double smaller = std::numbers::sqrt2 / 2, smallest = 1e-9;
  context.step("open");
  validate(drop, target);
  std::vector<Index> loop = checked_loop(source, "source", source_loop);
  if (windings_disagree(target, source)) std::reverse(loop.begin(), loop.end());  // as it will be turned over
  const FlatLoop flat = flatten(source, std::move(loop));
  const auto finished = [&](OpenedHole hole) {
    if (flat.smoothed)
      hole.notes.emplace_back(
          "the source's loop crosses itself as seen along its axis; the hole is rounded off");
    return hole;
  };

  if (drop.size) {
    auto result = open_at_size(target, flat, *drop.size, drop, context);
    if (const auto* misfit = std::get_if<Misfit>(&result))
      throw Error(ErrorCode::input, misfit->what, "place", "Name another place, or a smaller size");
    Opening& opening = std::get<Opening>(result);
    if (opening.width_rel < roomy)
      opening.hole.notes.push_back(
          fmt::format("the surface is narrow there: the hole is {:.2f} times as wide as the part's loop; a "
                      "smaller size fits better",
                      opening.width_rel));
    return finished(std::move(opening.hole));
  }

  const Points& x = target.positions;
  const double diagonal = x.rows() > 0 ? (x.colwise().maxCoeff() - x.colwise().minCoeff()).norm() : 0;
  std::string why = "the loop is larger than the target";
  for (double size = 1; size > smallest; size *= smaller) {
    if (size * flat.outline.width() > diagonal) continue;
    auto result = open_at_size(target, flat, size, drop, context);
    if (const auto* misfit = std::get_if<Misfit>(&result)) {
      why = misfit->what;
      continue;
    }
    Opening& opening = std::get<Opening>(result);
    if (opening.flatness < roomy) {
      why = "the surface is too narrow there for the loop";
      continue;
    }
    if (size < 1) opening.hole.notes.push_back(fmt::format("the part is scaled by {:.3g}: {}", size, why));
    return finished(std::move(opening.hole));
  }
  throw Error(ErrorCode::input, why, "place", "Name another place, or a smaller size");
}

}  // namespace meshgraft
