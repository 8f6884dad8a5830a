#include <algorithm>
#include <array>
#include <map>
#include <set>
#include <string>
#include <utility>

#include <meshgraft/core/error.h>
#include <meshgraft/mesh/cut.h>

#include "core/facts.h"
#include "core/sparse_checks.h"
#include "cut_snap.h"
#include "drawn_cut.h"
#include "mesh/disjoint_sets.h"
#include "mesh/edge_table.h"
#include "mesh/facts.h"
#include "mesh/fans.h"
#include "surface_path.h"

namespace meshgraft {

namespace {

constexpr double least_gap_rel = 1e-9;  // between two crossings of an edge, × its length

// A point of the curve, as SurfacePaths returns it, and the index of the listed vertex before it.
struct CurvePoint {
  EdgePoint at;
  std::size_t leg = 0;
  bool at_vertex() const { return at.from == at.to; }
  bool touches(Index v) const { return at.from == v || at.to == v; }
};

Location location_of(Index v) { return Location::place("vertex " + std::to_string(v)); }

void check_vertices(const Mesh& mesh, std::span<const Index> vertices) {
  if (vertices.size() < 3) throw Error(facts::mesh::LoopTooShort{.count = vertices.size()});
  std::set<Index> seen;
  for (const Index v : vertices) {
    if (v < 0 || v >= mesh.vertex_count())
      throw Error(facts::core::NoSuchVertex{.vertex = v, .count = mesh.vertex_count()});
    if (!seen.insert(v).second) throw Error(facts::mesh::LoopRepeatsVertex{.vertex = v}, location_of(v));
    if (!mesh.positions.row(v).allFinite())
      throw Error(facts::mesh::PositionNotFinite{.vertex = v}, location_of(v));
  }
}

class LoopCut {
 public:
  LoopCut(const Mesh& mesh, std::span<const Index> vertices, const Context& context)
      : mesh_(mesh),
        stations_(vertices),
        coarse_(triangulate_chosen(mesh, [](Index) { return true; })),
        table_(mesh.vertex_count(), coarse_.faces, context),
        context_(context) {
    for (Index f = 0; f < coarse_.faces.size(); ++f) face_.insert(face_.end(), coarse_.faces[f].size(), f);
    context.throw_if_stopped();
    cut_.positions = mesh.positions;
    for (Index v = 0; v < mesh.vertex_count(); ++v) cut_.origin.push_back(same(v));
  }

  CutResult run(const CutOptions& options) {
    trace();
    drop_detours();
    require_simple();
    context_.step("cut", 0.4);
    if (options.snap > 0) snap(options.snap);
    number_points();
    draw_chords();
    context_.throw_if_stopped();
    split_faces();
    context_.step("cut", 0.6);
    mark_sides(options.keep);
    cut_.vertex_side.assign(mesh_.vertex_count(), 0);
    context_.throw_if_stopped();
    cut_.normals = whole_normals(mesh_, cut_);
    context_.throw_if_stopped();
    return separate(mesh_, cut_, options.keep, context_);
  }

 private:
  // --- the curve ---

  void trace() {
    const SurfacePaths paths(mesh_.positions, coarse_.faces, table_);
    for (std::size_t leg = 0; leg < stations_.size(); ++leg) {
      context_.step("path", static_cast<double>(leg) / static_cast<double>(stations_.size()));
      const Index from = stations_[leg], to = stations_[(leg + 1) % stations_.size()];
      curve_.push_back({same(from), leg});
      for (const EdgePoint& point : paths.between(from, to, context_)) curve_.push_back({point, leg});
    }
  }

  // Drops points that add nothing: a point on an edge next to a point at an end of that edge, and a repeated
  // vertex.
  void drop_detours() {
    for (bool dropped = true; dropped;) {
      dropped = false;
      for (std::size_t k = 0; k < curve_.size() && curve_.size() > 1; ++k) {
        const CurvePoint &before = curve_[(k + curve_.size() - 1) % curve_.size()], &here = curve_[k],
                         &after = curve_[(k + 1) % curve_.size()];
        const bool repeats = here.at_vertex() && before.at_vertex() && here.at.from == before.at.from;
        const bool beside_end = !here.at_vertex() && ((before.at_vertex() && here.touches(before.at.from)) ||
                                                      (after.at_vertex() && here.touches(after.at.from)));
        if (!repeats && !beside_end) continue;
        curve_.erase(curve_.begin() + static_cast<std::ptrdiff_t>(k));
        dropped = true;
        break;
      }
    }
  }

  Index leg_end(std::size_t leg) const { return stations_[(leg + 1) % stations_.size()]; }

  [[noreturn]] void fail_crossing(const CurvePoint& a, const CurvePoint& b) const {
    throw Error(facts::mesh::LoopCrossesItself{.from = stations_[a.leg],
                                               .to = leg_end(a.leg),
                                               .other_from = stations_[b.leg],
                                               .other_to = leg_end(b.leg)});
  }

  void require_simple() const {
    Mesh triangles;
    triangles.positions = mesh_.positions;
    triangles.faces = coarse_.faces;
    const std::vector<Index> fans = fan_counts(triangles, table_);
    Flags on_border(mesh_.vertex_count(), false);
    for (Index e = 0; e < table_.edge_count(); ++e)
      if (table_.half_edges[e].size() != 2) on_border[table_.ends[e][0]] = on_border[table_.ends[e][1]] = true;
    std::map<Index, const CurvePoint*> seen;
    for (const CurvePoint& point : curve_) {
      if (!point.at_vertex()) continue;
      if (const Index v = point.at.from; on_border[v] || fans[v] != 1)
        throw Error(
            facts::mesh::LoopTouchesBoundary{
                .vertex = v, .from = stations_[point.leg], .to = leg_end(point.leg)},
            location_of(v));
      if (const auto [other, is_new] = seen.try_emplace(point.at.from, &point); !is_new)
        fail_crossing(*other->second, point);
    }
    if (curve_.size() < 3) throw Error(facts::mesh::LoopEnclosesNothing{});
  }

  // --- snapping ---

  // Moves vertices onto the curve where it passes within `limit` of an edge's length. A moved vertex replaces
  // all crossings of its edges. A vertex stays if the curve passes it twice, or if the faces around it would
  // lose their shape.
  void snap(double limit) {
    const FacesAround around(coarse_.faces, mesh_.vertex_count());
    std::map<Index, std::vector<std::size_t>> near;  // per vertex: the points on its edges
    std::set<Index> fixed;
    for (std::size_t k = 0; k < curve_.size(); ++k) {
      for (const Index v : {curve_[k].at.from, curve_[k].at.to}) {
        if (curve_[k].at_vertex())
          fixed.insert(v);
        else
          near[v].push_back(k);
      }
    }
    Flags gone(curve_.size(), false);
    for (const auto& [v, points] : near) {
      if (fixed.contains(v)) continue;
      std::size_t best = curve_.size();
      double nearest = 0;
      bool free = passes_once(points);
      for (const std::size_t k : points) {
        const EdgePoint& at = curve_[k].at;
        free = free && !gone[k] && at.from != at.to;
        const double t = v == at.from ? at.t : 1 - at.t;
        const double distance = t * (mesh_.positions.row(at.from) - mesh_.positions.row(at.to)).norm();
        if (t >= limit || (best < curve_.size() && distance >= nearest)) continue;
        best = k;
        nearest = distance;
      }
      if (!free || best == curve_.size()) continue;
      const EdgePoint& at = curve_[best].at;
      const EdgePoint move = v == at.from ? at : EdgePoint{at.to, at.from, 1 - at.t};
      const Eigen::RowVector3d target =
          (1 - move.t) * cut_.positions.row(move.from) + move.t * cut_.positions.row(move.to);
      if (!around.keep_shape(v, target, cut_.positions)) continue;
      cut_.positions.row(v) = target;
      cut_.origin[v] = move;
      for (const std::size_t k : points) gone[k] = k != best;
      curve_[best].at = same(v);
    }
    std::size_t kept = 0;
    for (std::size_t k = 0; k < curve_.size(); ++k)
      if (!gone[k]) curve_[kept++] = curve_[k];
    curve_.resize(kept);
  }

  // Returns whether the points are consecutive along the curve.
  bool passes_once(const std::vector<std::size_t>& points) const {
    int breaks = 0;
    for (std::size_t k = 0; k < points.size(); ++k) {
      const std::size_t following = points[(k + 1) % points.size()];
      if ((points[k] + 1) % curve_.size() != following) ++breaks;
    }
    return breaks <= 1;
  }

  // --- drawing ---

  Index edge_between(Index a, Index b) const {
    const std::array<Index, 2> ends{std::min(a, b), std::max(a, b)};
    const auto found = std::lower_bound(table_.ends.begin(), table_.ends.end(), ends);
    return found == table_.ends.end() || *found != ends ? -1 : static_cast<Index>(found - table_.ends.begin());
  }

  void number_points() {
    std::vector<Eigen::RowVector3d> inserted;
    for (const CurvePoint& point : curve_) {
      const auto& [a, b, t] = point.at;
      if (a == b) {
        number_.push_back(a);
        continue;
      }
      number_.push_back(mesh_.vertex_count() + static_cast<Index>(inserted.size()));
      on_edge_[edge_between(a, b)].emplace_back(t, number_.back());
      inserted.emplace_back((1 - t) * cut_.positions.row(a) + t * cut_.positions.row(b));
      cut_.origin.push_back(point.at);
    }
    for (auto& [edge, points] : on_edge_) sort_along_edge(points);
    cut_.positions.conservativeResize(mesh_.vertex_count() + static_cast<Eigen::Index>(inserted.size()), 3);
    for (std::size_t k = 0; k < inserted.size(); ++k)
      cut_.positions.row(mesh_.vertex_count() + static_cast<Eigen::Index>(k)) = inserted[k];
  }

  void sort_along_edge(std::vector<std::pair<double, Index>>& points) const {
    std::sort(points.begin(), points.end());
    for (std::size_t k = 1; k < points.size(); ++k) {
      if (points[k].first - points[k - 1].first > least_gap_rel) continue;
      fail_crossing(point_of(points[k - 1].second), point_of(points[k].second));
    }
  }

  const CurvePoint& point_of(Index vertex) const {
    return curve_[std::find(number_.begin(), number_.end(), vertex) - number_.begin()];
  }

  // A piece of the curve across a face, between two of the face's original or inserted vertices.
  struct Chord {
    Index from = 0, to = 0;
    std::size_t point = 0;  // index of the curve point where it begins
  };

  void draw_chords() {
    for (std::size_t k = 0; k < curve_.size(); ++k) {
      const std::size_t following = (k + 1) % curve_.size();
      const CurvePoint &a = curve_[k], &b = curve_[following];
      run_.emplace(number_[k], number_[following]);
      if (a.at_vertex() && b.at_vertex()) {
        if (const Index e = edge_between(a.at.from, b.at.from); e >= 0) {
          if (const auto crossed = on_edge_.find(e); crossed != on_edge_.end())
            fail_crossing(a, point_of(crossed->second.front().second));
          const auto along = table_.half_edges[e];
          const Index parent = coarse_.face_origin[face_[along[0]]];
          if (parent == coarse_.face_origin[face_[along[1]]]) on_diagonal_.insert(parent);
          continue;
        }
      }
      chords_[common_face(a, b)].push_back({number_[k], number_[following], k});
    }
  }

  Index common_face(const CurvePoint& a, const CurvePoint& b) const {
    const CurvePoint& on_edge = a.at_vertex() ? b : a;
    const CurvePoint& other = a.at_vertex() ? a : b;
    const Index e = edge_between(on_edge.at.from, on_edge.at.to);
    for (const Index c : table_.half_edges[e]) {
      const auto face = coarse_.faces[face_[c]];
      const auto has = [&](Index v) { return std::find(face.begin(), face.end(), v) != face.end(); };
      if (has(other.at.from) && has(other.at.to)) return face_[c];
    }
    fail_crossing(a, b);
  }

  // Emits the triangles split along the curve, and all other faces unchanged.
  void split_faces() {
    std::set<Index> touched;  // faces of the mesh
    for (const auto& [face, chords] : chords_) touched.insert(coarse_.face_origin[face]);
    for (const auto& [edge, points] : on_edge_)
      for (const Index c : table_.half_edges[edge]) touched.insert(coarse_.face_origin[face_[c]]);
    for (const Index f : on_diagonal_) touched.insert(f);
    Index f = 0;
    for (Index parent = 0; parent < mesh_.face_count(); ++parent) {
      if (touched.contains(parent)) {
        for (; f < coarse_.faces.size() && coarse_.face_origin[f] == parent; ++f) split(f);
        continue;
      }
      while (f < coarse_.faces.size() && coarse_.face_origin[f] == parent) ++f;
      std::vector<EdgePoint> corners;
      for (Index c = mesh_.faces.first_corner(parent); c < mesh_.faces.first_corner(parent + 1); ++c)
        corners.push_back(same(c));
      cut_.faces.add(mesh_.faces[parent], corners, parent);
    }
  }

  struct Node {
    Index vertex;
    EdgePoint corner;
  };
  using Polygon = std::vector<Node>;

  void split(Index face) {
    Polygon nodes;
    const Index first = coarse_.faces.first_corner(face);
    for (Index c = first; c < coarse_.faces.first_corner(face + 1); ++c) {
      nodes.push_back({coarse_.faces.corners()[c], coarse_.corner_origin[c]});
      if (table_.next[c] < 0) continue;
      const auto inserted = on_edge_.find(table_.edge[c]);
      if (inserted == on_edge_.end()) continue;
      const bool along = coarse_.faces.corners()[c] == table_.ends[table_.edge[c]][0];
      const Index tail = along ? c : table_.next[c], head = along ? table_.next[c] : c;
      const std::size_t before = nodes.size();
      for (const auto& [t, vertex] : inserted->second)
        nodes.push_back({vertex, {coarse_.corner_origin[tail].from, coarse_.corner_origin[head].from, t}});
      if (!along) std::reverse(nodes.begin() + static_cast<std::ptrdiff_t>(before), nodes.end());
    }
    const auto chords = chords_.find(face);
    const Index origin = coarse_.face_origin[face];
    if (chords == chords_.end()) return emit(nodes, origin);
    std::vector<Polygon> pieces{nodes};
    for (std::size_t k = 0; k < chords->second.size(); ++k) divide(pieces, chords->second, k);
    for (const Polygon& piece : pieces) emit(piece, origin);
  }

  // Divides the piece that contains both ends of the chord. No piece contains both if chords cross.
  void divide(std::vector<Polygon>& pieces, const std::vector<Chord>& chords, std::size_t k) const {
    for (Polygon& piece : pieces) {
      const auto corner_at = [&](Index v) {
        return std::find_if(piece.begin(), piece.end(), [&](const Node& node) { return node.vertex == v; });
      };
      auto a = corner_at(chords[k].from), b = corner_at(chords[k].to);
      if (a == piece.end() || b == piece.end()) continue;
      if (b < a) std::swap(a, b);
      Polygon one(a, b + 1), other(b, piece.end());
      other.insert(other.end(), piece.begin(), a + 1);
      if (one.size() < 3 || other.size() < 3) break;  // the chord runs along an edge
      piece = std::move(one);
      pieces.push_back(std::move(other));
      return;
    }
    fail_crossing(curve_[chords[k].point], curve_[chords[k == 0 ? chords.size() - 1 : k - 1].point]);
  }

  void emit(const Polygon& polygon, Index origin) {
    Mesh piece;
    piece.positions.resize(static_cast<Eigen::Index>(polygon.size()), 3);
    std::vector<Index> face;
    for (std::size_t k = 0; k < polygon.size(); ++k) {
      piece.positions.row(static_cast<Eigen::Index>(k)) = cut_.positions.row(polygon[k].vertex);
      face.push_back(static_cast<Index>(k));
    }
    piece.faces.push_back(face);
    const Triangles triangles = triangulate(piece).triangles;
    for (const auto& triangle : triangles.rowwise()) {
      const Node &a = polygon[triangle[0]], &b = polygon[triangle[1]], &c = polygon[triangle[2]];
      cut_.faces.add(std::array{a.vertex, b.vertex, c.vertex}, std::array{a.corner, b.corner, c.corner},
                     origin);
    }
  }

  // --- sides ---

  void mark_sides(CutKeep keep) {
    const Faces& faces = cut_.faces.faces;
    const EdgeTable table(static_cast<Index>(cut_.origin.size()), faces, context_);
    std::vector<Index> face_of;
    for (Index f = 0; f < faces.size(); ++f) face_of.insert(face_of.end(), faces[f].size(), f);
    cut_.side.assign(faces.corner_count(), 0);
    SparseChecks check(context_);
    for (Index c = 0; c < faces.corner_count(); ++c) {
      check();
      if (table.next[c] < 0) continue;
      const Index a = faces.corners()[c], b = faces.corners()[table.next[c]];
      cut_.side[c] = static_cast<Side>(run_.contains({a, b}) - run_.contains({b, a}));
    }
    DisjointSets components(faces.size());
    for (Index e = 0; e < table.edge_count(); ++e) {
      check();
      const auto along = table.half_edges[e];
      for (std::size_t k = 1; k < along.size(); ++k)
        if (cut_.side[along[0]] == 0) components.unite(face_of[along[0]], face_of[along[k]]);
    }
    Index above = -1, below = -1;
    for (Index c = 0; c < faces.corner_count(); ++c) {
      if (cut_.side[c] > 0) above = components.root(face_of[c]);
      if (cut_.side[c] < 0) below = components.root(face_of[c]);
    }
    cut_.face_side.assign(faces.size(), 0);
    if (above == below) {
      if (keep == CutKeep::both) return;
      throw Error(facts::mesh::LoopDoesNotPart{});
    }
    for (Index f = 0; f < faces.size(); ++f) {
      if (components.root(f) == above) cut_.face_side[f] = 1;
      if (components.root(f) == below) cut_.face_side[f] = -1;
    }
  }

  const Mesh& mesh_;
  std::span<const Index> stations_;
  const TracedFaces coarse_;  // triangles only
  const EdgeTable table_;
  const Context& context_;
  std::vector<Index> face_;  // per corner of `coarse_`: its face
  std::vector<CurvePoint> curve_;
  std::vector<Index> number_;                                       // per point of the curve: its vertex
  std::map<Index, std::vector<std::pair<double, Index>>> on_edge_;  // inserted vertices along each edge
  std::map<Index, std::vector<Chord>> chords_;                      // per face of `coarse_`
  std::set<std::pair<Index, Index>> run_;                           // the curve, from vertex to vertex
  std::set<Index> on_diagonal_;                                     // mesh faces with a diagonal on the curve
  DrawnCut cut_;
};

}  // namespace

CutResult cut_along_loop(const Mesh& mesh, std::span<const Index> vertices, const CutOptions& options,
                         const Context& context) {
  check(mesh, options);
  require_open(options);
  check_vertices(mesh, vertices);
  return LoopCut(mesh, vertices, context).run(options);
}

}  // namespace meshgraft
