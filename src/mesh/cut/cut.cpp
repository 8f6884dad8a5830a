#include <meshgraft/mesh/cut.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include <fmt/format.h>
#include <Eigen/Geometry>

#include <meshgraft/core/error.h>

#include "cap.h"
#include "core/facts.h"
#include "core/sparse_checks.h"
#include "cut_snap.h"
#include "drawn_cut.h"
#include "mesh/disjoint_sets.h"
#include "mesh/edge_table.h"
#include "mesh/facts.h"

namespace meshgraft {

namespace {

constexpr double ulp = std::numeric_limits<double>::epsilon();

void check(const Mesh& mesh, std::span<const double> values, const CutOptions& options) {
  if (values.size() != static_cast<std::size_t>(mesh.vertex_count()))
    throw Error(facts::mesh::ValueCountMismatch{.values = values.size(), .vertices = mesh.vertex_count()});
  const auto missing = std::find_if(values.begin(), values.end(), [](double x) { return !std::isfinite(x); });
  if (const auto v = missing - values.begin(); missing != values.end())
    throw Error(facts::mesh::ValueNotFinite{.vertex = v}, Location::place(fmt::format("vertex {}", v)));
  check(mesh, options);
}

bool is_crossed(std::span<const Index> face, std::span<const double> values) {
  bool above = false, below = false;
  for (const Index v : face) {
    above = above || values[v] > 0;
    below = below || values[v] < 0;
  }
  return above && below;
}

// Moves crossings that round to an end of their edge onto that end.
void round_to_ends(const Faces& faces, const Points& positions, std::vector<double>& values) {
  for (Index f = 0; f < faces.size(); ++f) {
    const auto face = faces[f];
    for (std::size_t c = 0; c < face.size(); ++c) {
      const Index a = face[c], b = face[(c + 1) % face.size()];
      if (!opposite(values[a], values[b])) continue;
      const double t = crossing(values[a], values[b]);
      const double length = (positions.row(a) - positions.row(b)).norm();
      const double slack =
          4 * ulp * std::max(positions.row(a).cwiseAbs().maxCoeff(), positions.row(b).cwiseAbs().maxCoeff());
      if (t * length <= slack) values[a] = 0;
      if ((1 - t) * length <= slack) values[b] = 0;
    }
  }
}

// Returns the side of each face, or 0 if the cut crosses it. A connected set of faces that lie in the cut
// takes the side of its neighbours. It goes below if its neighbours are on both sides.
std::vector<Side> face_sides(const Faces& faces, const EdgeTable& table, std::span<const double> values) {
  std::vector<Side> side(faces.size(), 0);
  Flags in_the_cut(faces.size(), false);
  std::vector<Index> face_of;
  for (Index f = 0; f < faces.size(); ++f) {
    bool above = false, below = false;
    for (const Index v : faces[f]) {
      above = above || values[v] > 0;
      below = below || values[v] < 0;
    }
    side[f] = static_cast<Side>(above - below);
    in_the_cut[f] = !above && !below;
    face_of.insert(face_of.end(), faces[f].size(), f);
  }
  DisjointSets regions(faces.size());
  const auto for_neighbours = [&](const auto& visit) {
    for (Index e = 0; e < table.edge_count(); ++e)
      for (const Index a : table.half_edges[e])
        for (const Index b : table.half_edges[e])
          if (a != b) visit(face_of[a], face_of[b]);
  };
  for_neighbours([&](Index f, Index g) {
    if (in_the_cut[f] && in_the_cut[g]) regions.unite(f, g);
  });
  std::vector<Side> region_side(faces.size(), 0);
  for_neighbours([&](Index f, Index g) {
    if (!in_the_cut[f] || side[g] == 0) return;
    Side& region = region_side[regions.root(f)];
    region = region == 0 ? side[g] : std::min(region, side[g]);
  });
  for (Index f = 0; f < faces.size(); ++f)
    if (in_the_cut[f]) side[f] = region_side[regions.root(f)] > 0 ? 1 : -1;
  return side;
}

// Draws the cut into the faces; all crossed faces must be triangles.
class Drawing {
 public:
  Drawing(const TracedFaces& coarse, std::span<const double> values, DrawnCut& out, const Context& context)
      : coarse_(coarse),
        values_(values),
        out_(out),
        context_(context),
        table_(static_cast<Index>(values.size()), coarse.faces, context) {}

  void run() {
    insert_vertices();
    context_.throw_if_stopped();
    const std::vector<Side> side = face_sides(coarse_.faces, table_, values_);
    context_.throw_if_stopped();
    SparseChecks check(context_);
    for (Index f = 0; f < coarse_.faces.size(); ++f) {
      check();
      if (is_crossed(coarse_.faces[f], values_)) {
        split(f);
      } else {
        const Index first = coarse_.faces.first_corner(f);
        add(coarse_.faces[f], {coarse_.corner_origin.data() + first, coarse_.faces[f].size()}, f, side[f]);
      }
    }
    context_.throw_if_stopped();
    mark_sides();
  }

 private:
  struct Corner {
    Index vertex = -1;
    EdgePoint origin;
  };

  void insert_vertices() {
    middle_.assign(table_.edge_count(), -1);
    std::vector<Eigen::RowVector3d> inserted;
    const auto old_count = static_cast<Index>(values_.size());
    for (Index e = 0; e < table_.edge_count(); ++e) {
      const auto [a, b] = table_.ends[e];
      if (!opposite(values_[a], values_[b])) continue;
      const double t = crossing(values_[a], values_[b]);
      middle_[e] = old_count + static_cast<Index>(inserted.size());
      inserted.emplace_back((1 - t) * out_.positions.row(a) + t * out_.positions.row(b));
      out_.origin.push_back({a, b, t});
    }
    out_.positions.conservativeResize(old_count + static_cast<Eigen::Index>(inserted.size()), 3);
    for (std::size_t k = 0; k < inserted.size(); ++k)
      out_.positions.row(old_count + static_cast<Eigen::Index>(k)) = inserted[k];
  }

  void add(std::span<const Index> face, std::span<const EdgePoint> corners, Index coarse_face, Side side) {
    out_.faces.add(face, corners, coarse_.face_origin[coarse_face]);
    out_.face_side.push_back(side);
  }

  void add(const std::array<Corner, 3>& corners, Index coarse_face, Side side) {
    add(std::array{corners[0].vertex, corners[1].vertex, corners[2].vertex},
        std::array{corners[0].origin, corners[1].origin, corners[2].origin}, coarse_face, side);
  }

  Corner at_corner(Index c) const { return {coarse_.faces.corners()[c], coarse_.corner_origin[c]}; }

  Corner on_edge_after(Index c) const {
    const Index e = table_.edge[c], vertex = middle_[e];
    Index a = c, b = table_.next[c];
    if (coarse_.faces.corners()[a] != table_.ends[e][0]) std::swap(a, b);
    return {vertex, {coarse_.corner_origin[a].from, coarse_.corner_origin[b].from, out_.origin[vertex].t}};
  }

  double value_at(Index c) const { return values_[coarse_.faces.corners()[c]]; }

  void split(Index face) {
    Index c = coarse_.faces.first_corner(face);
    if (table_.next[c] < 0) return;  // two corners only: no surface
    // Start at the corner on the cut, or otherwise at the corner that is alone on its side.
    while (value_at(c) != 0 && opposite(value_at(table_.next[c]), value_at(table_.previous[c])))
      c = table_.next[c];
    for (const Index other : {table_.next[c], table_.previous[c]})
      if (value_at(other) == 0) c = other;
    const Index d = table_.next[c], e = table_.next[d];
    const Corner apex = at_corner(c), first = at_corner(d), second = at_corner(e);
    if (value_at(c) == 0) {
      const Corner middle = on_edge_after(d);
      add({apex, first, middle}, face, side_at(d));
      add({apex, middle, second}, face, side_at(e));
      return;
    }
    const Corner p = on_edge_after(c), q = on_edge_after(e);
    add({apex, p, q}, face, side_at(c));
    const Side other = side_at(d);
    if (std::min(shape(p, first, second), shape(p, second, q)) >=
        std::min(shape(p, first, q), shape(first, second, q))) {
      add({p, first, second}, face, other);
      add({p, second, q}, face, other);
    } else {
      add({p, first, q}, face, other);
      add({first, second, q}, face, other);
    }
  }

  Side side_at(Index c) const { return value_at(c) > 0 ? 1 : -1; }

  // Returns the area over the longest edge squared.
  double shape(const Corner& a, const Corner& b, const Corner& c) const {
    const Eigen::RowVector3d u = out_.positions.row(b.vertex) - out_.positions.row(a.vertex);
    const Eigen::RowVector3d v = out_.positions.row(c.vertex) - out_.positions.row(a.vertex);
    const double longest = std::max({u.squaredNorm(), v.squaredNorm(), (u - v).squaredNorm()});
    return longest > 0 ? u.transpose().cross(v.transpose()).norm() / longest : 0;
  }

  void mark_sides() {
    const Faces& faces = out_.faces.faces;
    const EdgeTable table(static_cast<Index>(out_.origin.size()), faces, context_);
    context_.throw_if_stopped();
    std::vector<Side> side;
    for (Index f = 0; f < faces.size(); ++f) side.insert(side.end(), faces[f].size(), out_.face_side[f]);
    out_.side.assign(side.size(), 0);
    for (Index e = 0; e < table.edge_count(); ++e) {
      const auto along = table.half_edges[e];
      const bool cut =
          std::any_of(along.begin(), along.end(), [&](Index c) { return side[c] != side[along[0]]; });
      if (!cut) continue;
      for (const Index c : along) out_.side[c] = side[c];
    }
  }

  const TracedFaces& coarse_;
  std::span<const double> values_;
  DrawnCut& out_;
  const Context& context_;
  const EdgeTable table_;
  std::vector<Index> middle_;  // per edge: the vertex inserted on it, or -1
};

void require_crossed(std::span<const double> heights) {
  if (heights.empty()) throw Error(facts::mesh::NoVertices{});
  const auto [low, high] = std::minmax_element(heights.begin(), heights.end());
  if (*low < 0 && *high > 0) return;
  const bool is_above = *low >= 0;
  throw Error(
      facts::mesh::PlaneMissesMesh{.side = is_above ? facts::mesh::Side::above : facts::mesh::Side::below,
                                   .low = is_above ? 0.0 + *low : 0.0 - *high,
                                   .high = is_above ? 0.0 + *high : 0.0 - *low});
}

CutResult cut_open(const Mesh& mesh, std::span<const double> values, const CutOptions& options,
                   const Context& context, bool* closed = nullptr) {
  check(mesh, values, options);
  context.step("cut", 0);
  const TracedFaces coarse =
      triangulate_chosen(mesh, [&](Index f) { return is_crossed(mesh.faces[f], values); });
  context.throw_if_stopped();
  std::vector<double> rounded(values.begin(), values.end());
  round_to_ends(coarse.faces, mesh.positions, rounded);

  context.throw_if_stopped();
  DrawnCut cut;
  cut.positions = mesh.positions;
  for (Index v = 0; v < mesh.vertex_count(); ++v) cut.origin.push_back(same(v));
  context.step("cut", 0.2);
  if (options.snap > 0) snap_to_cut(coarse.faces, options.snap, cut.positions, cut.origin, rounded, context);
  context.step("cut", 0.4);
  Drawing(coarse, rounded, cut, context).run();
  if (std::all_of(cut.side.begin(), cut.side.end(), [](Side side) { return side == 0; }))
    throw Error(facts::mesh::NothingCut{});
  for (const double value : rounded) cut.vertex_side.push_back(value > 0 ? 1 : -1);
  context.step("cut", 0.6);
  cut.normals = whole_normals(mesh, cut);
  context.throw_if_stopped();
  CutResult result = separate(mesh, cut, options.keep, context, closed);
  context.step("cut", 1);
  return result;
}

// Cuts at the zeros of heights over a plane, and closes the halves. Pins need both halves, whichever is kept.
CutResult cut_closed(const Mesh& mesh, std::span<const double> heights, const Plane& plane,
                     const CutOptions& options, const Context& context) {
  if (options.cap == CutCap::pins) check_pins(options);
  const PlaneFrame frame(plane);
  std::vector<PinFit> fits;
  CutOptions both = options;
  both.keep = CutKeep::both;
  bool closed = false;
  CutResult result = cut_open(mesh, heights, options.cap == CutCap::pins ? both : options, context, &closed);
  if (!closed) throw Error(facts::mesh::CapOutlineBranches{});
  if (options.cap == CutCap::pins) {
    fits = fit_pins(result, frame, options, context);
    if (options.keep != CutKeep::both) result = cut_open(mesh, heights, options, context);
  }
  close_cut(result, frame, fits, options, context);
  return result;
}

}  // namespace

CutResult cut_at_zero(const Mesh& mesh, std::span<const double> values, const CutOptions& options,
                      const Context& context) {
  require_open(options);
  return cut_open(mesh, values, options, context);
}

CutResult cut_by_plane(const Mesh& mesh, const Plane& plane, const CutOptions& options,
                       const Context& context) {
  check(mesh, options);
  const auto& [point, normal] = plane;
  const double length = normal.stableNorm();
  if (!point.allFinite()) throw Error(facts::core::NotFinite{.what = facts::core::Quantity::plane_point});
  if (!(length > 0) || !std::isfinite(length)) throw Error(facts::mesh::PlaneNormalUnusable{});
  const Eigen::Vector3d unit = normal / length;

  std::vector<double> values(mesh.vertex_count());
  for (Index v = 0; v < mesh.vertex_count(); ++v) {
    const Eigen::Vector3d x = mesh.positions.row(v);
    if (!x.allFinite())
      throw Error(facts::mesh::PositionNotFinite{.vertex = v}, Location::place(fmt::format("vertex {}", v)));
    const double rounding = 4 * ulp * (x.cwiseAbs().maxCoeff() + point.cwiseAbs().maxCoeff());
    values[v] = (x - point).dot(unit);
    if (std::abs(values[v]) <= rounding) values[v] = 0;
  }
  require_crossed(values);
  if (options.cap == CutCap::open) return cut_open(mesh, values, options, context);
  return cut_closed(mesh, values, plane, options, context);
}

std::vector<Index> vertices_at_cut(const CutResult& result) {
  std::vector<Index> vertices;
  const auto add = [&](const EdgePoint& origin) { vertices.insert(vertices.end(), {origin.from, origin.to}); };
  for (const EdgePoint& origin : result.origin)
    if (origin.from != origin.to) add(origin);
  for (const auto& loop : result.loops)
    for (const Index v : loop) add(result.origin[v]);
  std::sort(vertices.begin(), vertices.end());
  vertices.erase(std::unique(vertices.begin(), vertices.end()), vertices.end());
  return vertices;
}

}  // namespace meshgraft
