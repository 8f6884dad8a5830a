#include <meshgraft/merge/open_hole.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <numbers>
#include <span>
#include <utility>

#include <fmt/format.h>
#include <Eigen/Geometry>

#include <meshgraft/core/error.h>
#include <meshgraft/deform/intersections.h>
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
  if (const auto* point = std::get_if<Eigen::Vector3d>(&drop.surface_point); point != nullptr && !point->allFinite())
    throw Error(ErrorCode::input, "the point is not finite", "place");
  const auto* vertex = std::get_if<Index>(&drop.surface_point);
  if (vertex != nullptr && (*vertex < 0 || *vertex >= target.vertex_count()))
    throw Error(ErrorCode::input,
                fmt::format("target vertex {} does not exist; the mesh has {}", *vertex, target.vertex_count()),
                "place", "Name another vertex, or a point");
}

/// A source's loop, flattened: `axis` points to where the source is; the outline's origin is at `centre`.
struct FlatLoop {
  std::vector<Index> vertices;
  Vector axis, first_axis, centre;
  Outline outline;
  bool smoothed = false;
};

/// Moves a polygon's centre of area to the origin; where it was.
Eigen::RowVector2d centre(PlanePoints& polygon) {
  Eigen::RowVector2d sum = Eigen::RowVector2d::Zero();
  const Eigen::RowVector2d mean = polygon.colwise().mean();
  polygon.rowwise() -= mean;
  for (Eigen::Index i = 0; i < polygon.rows(); ++i) {
    const Eigen::RowVector2d a = polygon.row(i), b = polygon.row((i + 1) % polygon.rows());
    sum += (a.x() * b.y() - a.y() * b.x()) * (a + b) / 3;
  }
  const Eigen::RowVector2d shift = sum / double_area(polygon);
  polygon.rowwise() -= shift;
  return mean + shift;
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
  const Vector mean = points.colwise().mean();
  PlanePoints polygon = (points.rowwise() - mean) * axes;
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
  const Vector middle = mean + centre(polygon) * axes.transpose();
  return {std::move(loop), axis, first, middle, Outline(std::move(polygon)), !simple};
}

/// The target with what is asked of it again and again.
struct Surface {
  Surface(std::shared_ptr<const Mesh> shared_mesh, const Context& context)
      : shared(std::move(shared_mesh)),
        mesh(*shared),
        triangles(triangulate(mesh, {.skip_out_of_range = true}).triangles),
        rings(vertex_rings(mesh.vertex_count(), triangles, context)),
        normals(vertex_normals(mesh)) {}

  std::shared_ptr<const Mesh> shared;
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
  if (const auto* vertex = std::get_if<Index>(&drop.surface_point)) {
    if (surface.rings[*vertex].empty())
      throw Error(ErrorCode::input, fmt::format("target vertex {} belongs to no face", *vertex), "place",
                  "Name another vertex, or a point");
    return {surface.mesh.positions.row(*vertex), {*vertex}};
  }
  const Vector point = std::get<Eigen::Vector3d>(drop.surface_point).transpose();
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
  const double surely_outside = most_widened * scale * outline.reach();
  for (Eigen::Index v = 0; v < places.rows(); ++v)
    if (places.row(v).norm() <= surely_outside)  // and not NaN
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

constexpr const char* no_disc = "the loop reaches round the surface there, so that what it encloses is no disc";

/// Of the vertices, edges and triangles that lie wholly within the outline: 1 for a disc.
std::ptrdiff_t inner_euler_characteristic(const Surface& surface, const Drawing& drawing) {
  const auto is_inside = [&](Index v) { return drawing.is_inside(v); };
  std::ptrdiff_t half_edges = 0, faces = 0;
  for (const Index v : drawing.inside)
    half_edges += std::count_if(surface.rings[v].begin(), surface.rings[v].end(), is_inside);
  for (const auto& t : surface.triangles.rowwise()) faces += std::all_of(t.begin(), t.end(), is_inside) ? 1 : 0;
  return std::ssize(drawing.inside) - half_edges / 2 + faces;
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
  if (inner_euler_characteristic(surface, drawing) != 1) return Misfit{no_disc};
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

/// A surface spread out around a place.
struct Chart {
  Surface surface;
  SurfacePoint place;
  Vector normal, first_axis;  ///< of the tangent plane
  PlanePoints places;
};

std::shared_ptr<const Chart> spread_out(std::shared_ptr<const Mesh> mesh, const Drop& drop, double reach,
                                        const Context& context) {
  Surface surface(std::move(mesh), context);
  SurfacePoint place = place_on(surface, drop);
  const Vector normal = mean_normal(surface, place, 0), axis = normal.transpose().unitOrthogonal().transpose();
  PlanePoints places = exponential_map(surface.mesh.positions, surface.normals, surface.rings,
                                       {place.point, normal, axis, place.corners}, reach, context);
  return std::make_shared<Chart>(Chart{std::move(surface), std::move(place), normal, axis, std::move(places)});
}

/// An outline on a chart.
struct Layout {
  PlanePoints places;  ///< the chart's, along the outline's axes
  Drawing drawing;
};

/// How the outline stands on the surface: the axes that its own come to.
struct Stand {
  Vector normal, first_axis;
};

Stand stand_on(const Surface& surface, const SurfacePoint& place, const FlatLoop& loop, double size,
               double spin_deg) {
  const Vector normal = mean_normal(surface, place, size * loop.outline.reach());
  return {normal, laid_axis(loop, normal, spin_deg)};
}

Layout lay_out(const Chart& chart, const Outline& outline, double size, const Stand& stand) {
  const Vector axis = turned(stand.first_axis, stand.normal, chart.normal);
  const double x = axis.dot(chart.first_axis), y = axis.dot(chart.normal.cross(chart.first_axis));
  Eigen::Matrix2d turn;
  turn << x, -y, y, x;
  Layout layout{chart.places * turn, {}};
  layout.drawing = draw_as_wide(chart.surface, outline, size, layout.places);
  return layout;
}

/// The mesh with edges around the outline halved that are too long to draw it; null where there are none.
std::shared_ptr<const Mesh> refined_around(const Mesh& mesh, const Layout& layout, double longest,
                                           const Context& context) {
  const auto is_long = [&](Index a, Index b) {
    if (!layout.places.row(a).allFinite() || !layout.places.row(b).allFinite()) return false;
    const double length = (mesh.positions.row(a) - mesh.positions.row(b)).norm();
    const auto depth = [&](Index v) { return std::abs(layout.drawing.values[v]); };
    return length > longest && std::min(depth(a), depth(b)) <= length;
  };
  bool any = false;
  for (Index f = 0; f < mesh.face_count() && !any; ++f) {
    const auto face = mesh.faces[f];
    for (std::size_t c = 0; c < face.size(); ++c)
      for (std::size_t d = 0; d < c; ++d) any = any || is_long(face[c], face[d]);
  }
  if (!any) return nullptr;
  return std::make_shared<const Mesh>(split_edges(mesh, is_long, context).mesh);
}

/// An outline on a surface that has room for it.
struct Fit {
  std::shared_ptr<const Chart> chart;
  Layout layout;
  Stand stand;
  double size = 1;
};

/// What came of trying a size.
struct Trial {
  std::shared_ptr<const Fit> fit;  ///< null where there is no room
  std::string misfit;
};

/// Tries sizes of a loop at a place.
class Fitting {
 public:
  /// The chart is made once, for sizes up to `largest`.
  Fitting(const Mesh& target, const FlatLoop& loop, const Drop& drop, double largest, const Context& context)
      : loop_(loop),
        drop_(drop),
        context_(context),
        chart_(spread_out(std::shared_ptr<const Mesh>(&target, [](const Mesh*) {}), drop, reach(largest),
                          context)) {}

  /// Without `may_widen` the hole has to be as wide as the loop without having been widened much.
  Trial at(double size, bool may_widen) const {
    constexpr int most_halvings = 12;
    constexpr double edge_ratio = 2, fewest_edges = 24;
    const double longest = size * loop_.outline.length() /
                           std::max(fewest_edges, static_cast<double>(loop_.outline.size()) / edge_ratio);
    const Stand stand = stand_at(size);
    Fit fit{chart_, lay_out(*chart_, loop_.outline, size, stand), stand, size};
    for (int halving = 0; halving < most_halvings; ++halving) {
      const auto refined = refined_around(fit.chart->surface.mesh, fit.layout, longest, context_);
      if (!refined) break;
      fit.chart = spread_out(refined, drop_, reach(size), context_);
      fit.layout = lay_out(*fit.chart, loop_.outline, size, fit.stand);
    }
    if (std::optional<Misfit> obstacle = find_obstacle(fit.chart->surface, fit.layout.drawing))
      return {nullptr, std::move(obstacle->what)};
    const double width = drawn_width(fit.chart->surface, fit.layout.drawing) / loop_.outline.width();
    if (width < roomy * (may_widen ? size : fit.layout.drawing.scale))
      return {nullptr, "the surface is too narrow there for the loop"};
    return {std::make_shared<const Fit>(std::move(fit)), {}};
  }

  /// The largest size below one that does not fit, to three digits; 0 where none does.
  double largest_below(double size, double least) const {
    constexpr double step = std::numbers::sqrt2 / 2;
    constexpr int bisections = 3;
    const auto fits = [&](double s) { return at(s, true).fit != nullptr; };
    double too_large = size, fitting = rounded(size * step);
    for (; !fits(fitting); fitting = rounded(fitting * step)) {
      if (fitting < least) return 0;
      too_large = fitting;
    }
    for (int k = 0; k < bisections; ++k) {
      const double middle = rounded(std::sqrt(fitting * too_large));
      (fits(middle) ? fitting : too_large) = middle;
    }
    return fitting;
  }

 private:
  static double rounded(double size) { return std::stod(fmt::format("{:.3g}", size)); }
  double reach(double size) const { return most_widened * size * loop_.outline.reach(); }

  Stand stand_at(double size) const {
    return stand_on(chart_->surface, chart_->place, loop_, size, drop_.spin_deg);
  }

  const FlatLoop& loop_;
  const Drop& drop_;
  const Context& context_;
  std::shared_ptr<const Chart> chart_;
};

/// The place, at the mean height of the hole's rim.
Vector rim_centre(const Fit& fit) {
  const Surface& surface = fit.chart->surface;
  const Vector place = fit.chart->place.point;
  double height = 0;
  Index count = 0;
  for (const Index v : fit.layout.drawing.inside)
    for (const Index u : surface.rings[v]) {
      if (fit.layout.drawing.is_inside(u)) continue;
      const double s =
          fit.layout.drawing.values[v] / (fit.layout.drawing.values[v] - fit.layout.drawing.values[u]);
      const Vector crossing = (1 - s) * surface.mesh.positions.row(v) + s * surface.mesh.positions.row(u);
      height += (crossing - place).dot(fit.stand.normal);
      ++count;
    }
  return place + height / static_cast<double>(count) * fit.stand.normal;
}

/// Where the source's loop comes to stand upright, around `centre`.
Eigen::Affine3d stand_map(const FlatLoop& loop, const Stand& stand, double size, const Vector& centre) {
  Eigen::Matrix3d from, to;
  from << loop.first_axis.transpose(), loop.axis.cross(loop.first_axis).transpose(), loop.axis.transpose();
  to << stand.first_axis.transpose(), stand.normal.cross(stand.first_axis).transpose(),
      stand.normal.transpose();
  Eigen::Affine3d map = Eigen::Affine3d::Identity();
  map.linear() = size * to * from.transpose();
  map.translation() = centre.transpose() - map.linear() * loop.centre.transpose();
  return map;
}

/// Whether the source, as it would stand there undeformed, cuts through the target beyond its loop's radius.
bool cuts_through(const Mesh& source, const FlatLoop& loop, const Fit& fit, const Context& context) {
  const Surface& surface = fit.chart->surface;
  const Eigen::Affine3d map = stand_map(loop, fit.stand, fit.size, rim_centre(fit));
  const Points posed = (source.positions * map.linear().transpose()).rowwise() + map.translation().transpose();
  const Triangles triangles = triangulate(source, {.skip_out_of_range = true}).triangles;
  const Index offset = surface.mesh.vertex_count();
  std::vector<Index> corners;
  for (const auto& t : surface.triangles.rowwise())
    if (std::none_of(t.begin(), t.end(), [&](Index v) { return fit.layout.drawing.is_inside(v); }))
      corners.insert(corners.end(), t.begin(), t.end());
  const auto of_target = static_cast<Index>(corners.size() / 3);
  const double radius = loop.outline.width() / std::sqrt(std::numbers::pi);
  const std::vector<double> away =
      edge_distance(loop.vertices, source.positions, vertex_rings(source.vertex_count(), triangles), radius);
  std::vector<Index> free;
  for (const auto& t : triangles.rowwise()) {
    if (std::any_of(t.begin(), t.end(), [&](Index v) { return std::isfinite(away[v]); })) continue;
    for (const Index v : t) {
      corners.push_back(offset + v);
      free.push_back(offset + v);
    }
  }
  Points points(offset + posed.rows(), 3);
  points << surface.mesh.positions, posed;
  const auto pairs = self_intersections(
      points, Eigen::Map<const Triangles>(corners.data(), static_cast<Eigen::Index>(corners.size() / 3), 3),
      free, context);
  return std::any_of(pairs.begin(), pairs.end(),
                     [&](const TrianglePair& pair) { return pair[0] < of_target && pair[1] >= of_target; });
}

/// Cuts the outline's inside away.
std::variant<OpenedHole, Misfit> cut_open(const Fit& fit, const FlatLoop& loop, Index target_vertices,
                                          const Context& context) {
  constexpr double snap = 0.25;  // the ring around the hole goes anyway
  const auto& [places, drawing] = fit.layout;
  CutResult cut =
      cut_at_zero(fit.chart->surface.mesh, drawing.values, {.keep = CutKeep::above, .snap = snap}, context);
  if (cut.loops.size() != 1) return Misfit{no_disc};
  std::vector<double> arcs;
  for (const Index v : cut.loops.front()) {
    const EdgePoint& origin = cut.origin[static_cast<std::size_t>(v)];
    const Eigen::RowVector2d place =
        (1 - origin.t) * places.row(origin.from) + origin.t * places.row(origin.to);
    arcs.push_back(loop.outline.arc_of_nearest(place / drawing.scale));
  }
  OpenedHole hole;
  hole.pair = {{loop.vertices, cut.loops.front()},
               matches_along(loop.outline, loop.vertices, cut.loops.front(), arcs)};
  hole.vertex = std::move(cut.vertex);
  hole.vertex.new_index.resize(static_cast<std::size_t>(target_vertices));
  hole.target = std::move(cut.mesh);
  hole.size = fit.size;
  return hole;
}

/// Sizes that a loop may have on a target at all.
struct SizeRange {
  double least, largest;

  SizeRange(const Mesh& target, const FlatLoop& loop) {
    constexpr double least_width = 1e-6;  // × the target's diagonal
    const Points& x = target.positions;
    const double diagonal = x.rows() > 0 ? (x.colwise().maxCoeff() - x.colwise().minCoeff()).norm() : 0;
    largest = diagonal / loop.outline.width();
    least = least_width * largest;
  }
};

constexpr double smaller = std::numbers::sqrt2 / 2;  // the next size that is tried

constexpr int most_tries_to_clear = 4;

/// What to do where the part reaches into the target.
std::string advice_to_clear(const Mesh& source, const FlatLoop& loop, const Fitting& fitting, double size,
                            const Context& context) {
  double other = size;
  for (int k = 0; k < most_tries_to_clear; ++k) {
    other *= smaller;
    const Trial trial = fitting.at(other, true);
    if (trial.fit && !cuts_through(source, loop, *trial.fit, context))
      return fmt::format("the part reaches into the target at size {:.3g}; at {:.3g} it stands clear", size,
                         other);
  }
  return "the part reaches into the target; another spin or place may help";
}

OpenedHole open_at_size(const Mesh& target, const Mesh& source, const FlatLoop& loop, const Drop& drop,
                        const Context& context) {
  const SizeRange range(target, loop);
  const double size = *drop.size;
  if (size < range.least)
    throw Error(
        ErrorCode::input,
        fmt::format("the part's loop would be less than a millionth of the target's size at {:.3g}", size),
        "size", fmt::format("Use a size of {:.2g} or more", 1.1 * range.least));
  const Fitting fitting(target, loop, drop, std::min(size, range.largest), context);
  std::string problem = "the part's loop is larger than the target";
  if (size <= range.largest) {
    const Trial trial = fitting.at(size, true);
    problem = trial.misfit;
    if (trial.fit) {
      auto opened = cut_open(*trial.fit, loop, target.vertex_count(), context);
      if (auto* hole = std::get_if<OpenedHole>(&opened)) {
        hole->clear = !cuts_through(source, loop, *trial.fit, context);
        if (!hole->clear) hole->notes.push_back(advice_to_clear(source, loop, fitting, size, context));
        return std::move(*hole);
      }
      problem = std::get<Misfit>(opened).what;
    }
  }
  const double fits = fitting.largest_below(std::min(size, range.largest), range.least);
  throw Error(ErrorCode::input, fmt::format("{}, at size {:.3g}", problem, size), "place",
              fits > 0 ? fmt::format("Use a size of at most {:.3g}, or name another place", fits)
                       : "Name another place");
}

/// In the part's own size, or the largest smaller one that has room and does not cut through the target.
OpenedHole open_at_largest_size(const Mesh& target, const Mesh& source, const FlatLoop& loop, const Drop& drop,
                                const Context& context) {
  constexpr double least_width = 1e-3;  // × the target's diagonal
  const SizeRange range(target, loop);
  if (range.least > 1)
    throw Error(ErrorCode::input, "the part's loop is less than a millionth of the target's size", "size",
                fmt::format("Are their units different? Give a size of {:.2g} or more", 1.1 * range.least));
  const double least = std::min(smaller, least_width * range.largest);
  const Fitting fitting(target, loop, drop, std::min(1.0, range.largest), context);
  std::string why = "the part's loop is larger than the target";
  const auto open = [&](const Fit& fit, const std::string& reason) -> std::optional<OpenedHole> {
    auto opened = cut_open(fit, loop, target.vertex_count(), context);
    if (auto* hole = std::get_if<OpenedHole>(&opened)) {
      if (fit.size < 1)
        hole->notes.push_back(fmt::format("the part is scaled by {:.3g}: {}", fit.size, reason));
      return std::move(*hole);
    }
    why = std::get<Misfit>(opened).what;
    return std::nullopt;
  };
  std::shared_ptr<const Fit> widest;  // that has room, but reaches into the target
  std::string why_widest;
  int tries = 0;
  for (double size = 1; size >= least && tries < most_tries_to_clear; size *= smaller) {
    if (size > range.largest) continue;
    const Trial trial = fitting.at(size, false);
    if (!trial.fit) {
      why = trial.misfit;
    } else if (!cuts_through(source, loop, *trial.fit, context)) {
      if (auto hole = open(*trial.fit, why)) return *std::move(hole);
    } else {
      ++tries;
      if (!widest) {
        widest = trial.fit;
        why_widest = why;
      }
      why = "it would reach into the target";
    }
  }
  if (widest) {
    if (auto hole = open(*widest, why_widest)) {
      hole->clear = false;
      hole->notes.emplace_back("the part reaches into the target; another spin or place may help");
      return *std::move(hole);
    }
  }
  throw Error(ErrorCode::input, why, "place", "Name another place");
}

/// A hole around a vertex of the boundary would reach it at any size.
void require_inner_place(const Mesh& target, const Drop& drop) {
  const auto* vertex = std::get_if<Index>(&drop.surface_point);
  if (vertex == nullptr) return;
  for (const auto& loop : boundary_loops(target))
    if (std::find(loop.begin(), loop.end(), *vertex) != loop.end())
      throw Error(ErrorCode::input, fmt::format("target vertex {} is on the boundary", *vertex), "place",
                  "Name a vertex farther inside, or fill the hole there by a merge without --at");
}

FlatLoop flat_loop(const Mesh& target, const Mesh& source, const std::vector<Index>& source_loop) {
  std::vector<Index> loop = checked_loop(source, "source", source_loop);
  if (windings_disagree(target, source)) std::reverse(loop.begin(), loop.end());  // as it will be turned over
  return flatten(source, std::move(loop));
}

}  // namespace

struct DropGuide::Scenery {
  Surface surface;
  FlatLoop loop;
};

DropGuide::DropGuide(std::shared_ptr<const Mesh> target, const Mesh& source,
                     const std::vector<Index>& source_loop, const Context& context) {
  FlatLoop loop = flat_loop(*target, source, source_loop);
  scenery_ = std::make_shared<const Scenery>(Surface(std::move(target), context), std::move(loop));
}

Eigen::Affine3d DropGuide::pose(const Drop& drop) const {
  const auto& [surface, loop] = *scenery_;
  validate(drop, surface.mesh);
  const SurfacePoint place = place_on(surface, drop);
  const double size = drop.size.value_or(1);
  return stand_map(loop, stand_on(surface, place, loop, size, drop.spin_deg), size, place.point);
}

OpenedHole open_hole(const Mesh& target, const Mesh& source, const std::vector<Index>& source_loop,
                     const Drop& drop, const Context& context) {
  context.step("open");
  validate(drop, target);
  require_inner_place(target, drop);
  const FlatLoop flat = flat_loop(target, source, source_loop);
  OpenedHole hole = drop.size ? open_at_size(target, source, flat, drop, context)
                              : open_at_largest_size(target, source, flat, drop, context);
  if (flat.smoothed)
    hole.notes.emplace_back("the source's loop crosses itself as seen along its axis; the hole is rounded off");
  return hole;
}

}  // namespace meshgraft
