#include "drawn_cut.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <set>
#include <utility>

#include <fmt/format.h>

#include <meshgraft/core/error.h>
#include <meshgraft/mesh/normals.h>
#include <meshgraft/mesh/topology.h>

#include "core/facts.h"
#include "core/sparse_checks.h"
#include "mesh/disjoint_sets.h"
#include "mesh/edge_table.h"
#include "mesh/facts.h"
#include "mesh/join.h"
#include "mesh/outlying.h"

namespace meshgraft {

namespace {

bool is_kept(Side side, CutKeep keep) {
  return side == 0 || keep == CutKeep::both || (side > 0) == (keep == CutKeep::above);
}

// Corners around a vertex on the cut that are connected by edges, and their side of the cut.
struct Fan {
  Index vertex = 0, first_corner = 0;
  Side side = 0;
};

class Separation {
 public:
  Separation(const Mesh& mesh, const DrawnCut& cut, CutKeep keep, const Context& context)
      : mesh_(mesh),
        cut_(cut),
        keep_(keep),
        context_(context),
        table_(static_cast<Index>(cut.origin.size()), cut.faces.faces, context),
        fan_of_(cut.faces.faces.corner_count()) {}

  CutResult run() {
    find_fans();
    context_.step("cut", 0.7);
    number_vertices();
    context_.step("cut", 0.8);
    copy_faces();
    context_.throw_if_stopped();
    copy_attributes();
    context_.step("cut", 0.9);
    name_loops();
    context_.throw_if_stopped();
    keep_normals();
    result_.mesh.source = sources_of(mesh_);
    return std::move(result_);
  }

  // Returns whether all edges along the cut are in these loops.
  bool are_in_loops(const std::vector<std::vector<Index>>& loops) const {
    std::set<std::pair<Index, Index>> found;
    for (const auto& loop : loops)
      for (std::size_t k = 0; k < loop.size(); ++k)
        found.insert(std::minmax(loop[k], loop[(k + 1) % loop.size()]));
    return std::all_of(cut_edges_.begin(), cut_edges_.end(),
                       [&](const auto& edge) { return found.contains(std::minmax(edge.first, edge.second)); });
  }

 private:
  const std::vector<Index>& corners() const { return cut_.faces.faces.corners(); }

  void find_fans() {
    on_cut_.assign(cut_.origin.size(), false);
    for (Index c = 0; c < cut_.faces.faces.corner_count(); ++c)
      if (cut_.side[c] != 0) on_cut_[corners()[c]] = on_cut_[corners()[table_.next[c]]] = true;
    SparseChecks check(context_);
    for (Index e = 0; e < table_.edge_count(); ++e) {
      check();
      const auto along = table_.half_edges[e];
      for (std::size_t j = 0; j < along.size(); ++j)
        for (std::size_t k = j + 1; k < along.size(); ++k) join_fans(along[j], along[k]);
    }
  }

  // Joins the fans of two half-edges along one edge, unless the cut runs between them.
  void join_fans(Index a, Index b) {
    if (cut_.side[a] != cut_.side[b]) return;
    const bool same_tail = corners()[a] == corners()[b];
    fan_of_.unite(a, same_tail ? b : table_.next[b]);
    fan_of_.unite(table_.next[a], same_tail ? table_.next[b] : b);
  }

  // Returns the fans around vertices on the cut that have a face to keep. Those above come first, then those
  // below, each in vertex order.
  std::vector<Fan> kept_fans() {
    std::vector<Fan> fans;
    std::vector<std::size_t> number(corners().size(), 0);  // 1 + its index in `fans`, at its first corner
    const Faces& faces = cut_.faces.faces;
    SparseChecks check(context_);
    for (Index f = 0; f < faces.size(); ++f) {
      check();
      if (!is_kept(cut_.face_side[f], keep_)) continue;
      for (Index c = faces.first_corner(f); c < faces.first_corner(f + 1); ++c) {
        if (!on_cut_[corners()[c]] || table_.next[c] < 0) continue;
        const Index root = fan_of_.root(c);
        if (number[root] == 0) {
          fans.push_back({corners()[c], root, cut_.face_side[f]});
          number[root] = fans.size();
        }
        for (const Side side : {cut_.side[c], cut_.side[table_.previous[c]]})
          if (side != 0) fans[number[root] - 1].side = side;
      }
    }
    std::sort(fans.begin(), fans.end(), [](const Fan& a, const Fan& b) {
      return std::tuple(a.side < 0, a.vertex, a.first_corner) <
             std::tuple(b.side < 0, b.vertex, b.first_corner);
    });
    return fans;
  }

  void number_vertices() {
    const Index old_count = mesh_.vertex_count();
    const auto vertices = static_cast<Index>(cut_.origin.size());
    Flags in_a_face(vertices, false), kept(vertices, false);
    const Faces& faces = cut_.faces.faces;
    for (Index f = 0; f < faces.size(); ++f) {
      for (const Index v : faces[f]) {
        in_a_face[v] = true;
        if (is_kept(cut_.face_side[f], keep_)) kept[v] = true;
      }
    }
    new_index_.assign(vertices, -1);
    const auto append = [&](Index v) {
      if (new_index_[v] < 0) new_index_[v] = static_cast<Index>(source_.size());
      source_.push_back(v);
    };
    for (Index v = 0; v < old_count; ++v) {
      if (on_cut_[v]) continue;
      if (in_a_face[v] ? kept[v] : is_kept(cut_.vertex_side[v], keep_)) append(v);
    }
    copy_of_fan_.assign(corners().size(), -1);
    for (const Fan& fan : kept_fans()) {
      copy_of_fan_[fan.first_corner] = static_cast<Index>(source_.size());
      append(fan.vertex);
    }
    context_.throw_if_stopped();
    result_.vertex.new_index.assign(new_index_.begin(), new_index_.begin() + old_count);
    result_.mesh.positions.resize(static_cast<Eigen::Index>(source_.size()), 3);
    for (std::size_t k = 0; k < source_.size(); ++k) {
      result_.mesh.positions.row(static_cast<Eigen::Index>(k)) = cut_.positions.row(source_[k]);
      result_.origin.push_back(cut_.origin[source_[k]]);
    }
  }

  Index copy_at(Index corner) {
    if (!on_cut_[corners()[corner]]) return new_index_[corners()[corner]];
    const Index copy = copy_of_fan_[fan_of_.root(corner)];
    return copy >= 0 ? copy : new_index_[corners()[corner]];  // a corner that repeats another belongs to no fan
  }

  void copy_faces() {
    const Faces& faces = cut_.faces.faces;
    std::vector<Index> face;
    SparseChecks check(context_);
    for (Index f = 0; f < faces.size(); ++f) {
      check();
      if (!is_kept(cut_.face_side[f], keep_)) continue;
      face.clear();
      for (Index c = faces.first_corner(f); c < faces.first_corner(f + 1); ++c) {
        face.push_back(copy_at(c));
        corner_origin_.push_back(cut_.faces.corner_origin[c]);
        if (cut_.side[c] != 0) cut_edges_.emplace(copy_at(c), copy_at(table_.next[c]));
      }
      result_.mesh.faces.push_back(face);
      result_.face_parent.push_back(cut_.faces.face_origin[f]);
      result_.face_side.push_back(cut_.face_side[f]);
    }
  }

  void copy_attributes() {
    std::vector<EdgePoint> face_origin;
    for (const Index f : result_.face_parent) face_origin.push_back(same(f));
    for (const Attribute& attribute : mesh_.attributes) {
      context_.throw_if_stopped();
      switch (attribute.domain) {
        case Domain::vertex:
          result_.mesh.attributes.push_back(interpolate_attribute(attribute, result_.origin));
          break;
        case Domain::face:
          result_.mesh.attributes.push_back(interpolate_attribute(attribute, face_origin));
          break;
        case Domain::corner: result_.mesh.attributes.push_back(carry_corners(attribute)); break;
      }
    }
  }

  // Interpolates the values of corners whose vertex was moved along an edge.
  Attribute carry_corners(const Attribute& attribute) const {
    std::vector<EdgePoint> origin = corner_origin_;
    for (EdgePoint& element : origin)
      if (element.t == 0) element = moved_corner(attribute, element.from);
    return interpolate_attribute(attribute, origin);
  }

  // In the faces at that edge a corner value is interpolated along it. In other faces it follows a corner at
  // the vertex with the same value, so that continuous values stay continuous. Beyond an attribute seam it
  // stays unchanged.
  EdgePoint moved_corner(const Attribute& attribute, Index corner) const {
    const EdgePoint& move = cut_.origin[mesh_.faces.corners()[corner]];
    if (move.t == 0) return same(corner);
    const Index face = face_of(corner);
    if (const Index other = corner_at(face, move.to); other >= 0) return {corner, other, move.t};
    for (const Index f : faces_at(move)) {
      const Index twin = corner_at(f, move.from);
      const double* values = attribute.values.data();
      const auto width = static_cast<std::ptrdiff_t>(attribute.components);
      if (std::equal(values + corner * width, values + (corner + 1) * width, values + twin * width))
        return {twin, corner_at(f, move.to), move.t};
    }
    return same(corner);
  }

  Index face_of(Index corner) const {
    const auto& offsets = mesh_.faces.offsets();
    return static_cast<Index>(std::upper_bound(offsets.begin(), offsets.end(), corner) - offsets.begin()) - 1;
  }

  Index corner_at(Index face, Index vertex) const {
    const auto corners = mesh_.faces[face];
    const auto found = std::find(corners.begin(), corners.end(), vertex);
    return found == corners.end()
               ? -1
               : mesh_.faces.first_corner(face) + static_cast<Index>(found - corners.begin());
  }

  // Returns the faces of the mesh at the edge along which a vertex was moved.
  std::vector<Index> faces_at(const EdgePoint& move) const {
    std::vector<Index> found;
    const std::array<Index, 2> ends{std::min(move.from, move.to), std::max(move.from, move.to)};
    const auto edge = std::lower_bound(table_.ends.begin(), table_.ends.end(), ends);
    if (edge == table_.ends.end() || *edge != ends) return found;
    for (const Index half_edge : table_.half_edges[static_cast<Index>(edge - table_.ends.begin())])
      found.push_back(face_of(cut_.faces.corner_origin[half_edge].from));
    return found;
  }

  void name_loops() {
    auto loops = boundary_loops(result_.mesh);
    context_.throw_if_stopped();
    for (auto& loop : loops) {
      bool made = false;
      for (std::size_t k = 0; k < loop.size(); ++k)
        made = made || cut_edges_.contains({loop[k], loop[(k + 1) % loop.size()]});
      if (made) result_.loops.push_back(std::move(loop));
    }
  }

  void keep_normals() {
    auto& attributes = result_.mesh.attributes;
    const auto is_cut_normal = [](const Attribute& attribute) {
      return attribute.domain == Domain::vertex && attribute.name == cut_normal_name;
    };
    auto kept = std::find_if(attributes.begin(), attributes.end(), is_cut_normal);
    if (kept == attributes.end()) kept = attributes.insert(kept, {.name = cut_normal_name});
    if (kept->components != 3) {
      *kept = {.name = cut_normal_name,
               .interpolation = Interpolation::direction,
               .components = 3,
               .source_names = {"cut_nx", "cut_ny", "cut_nz"}};
      kept->values.assign(3 * source_.size(), std::numeric_limits<double>::quiet_NaN());
    }
    for (const auto& loop : result_.loops)
      for (const Index v : loop)
        for (int k = 0; k < 3; ++k)
          if (!cut_.normals.row(source_[v]).isZero(0))
            kept->values[3 * static_cast<std::size_t>(v) + k] = cut_.normals(source_[v], k);
  }

  const Mesh& mesh_;
  const DrawnCut& cut_;
  const CutKeep keep_;
  const Context& context_;
  const EdgeTable table_;
  DisjointSets fan_of_;                          // over the corners
  Flags on_cut_;                                 // per vertex
  std::vector<Index> new_index_;                 // per vertex: its first copy, or -1
  std::vector<Index> copy_of_fan_;               // per corner, at the fan's root
  std::vector<Index> source_;                    // per new vertex
  std::vector<EdgePoint> corner_origin_;         // per new corner
  std::set<std::pair<Index, Index>> cut_edges_;  // new half-edges
  CutResult result_;
};

}  // namespace

void check(const Mesh& mesh, const CutOptions& options) {
  if (mesh.face_count() == 0) throw Error(facts::core::NoFaces{});
  for (Index v = 0; v < mesh.vertex_count(); ++v)
    if (const double size = mesh.positions.row(v).cwiseAbs().maxCoeff();
        size > largest_coordinate && std::isfinite(size))
      throw Error(facts::mesh::CoordinateTooLarge{.vertex = v, .size = size},
                  Location::place(fmt::format("vertex {}", v)));
  if (!(options.snap >= 0 && options.snap <= 0.5))
    throw Error(facts::core::OutOfRange{.value = options.snap, .low = 0, .high = 0.5}, "snap");
}

void require_open(const CutOptions& options) {
  if (options.cap != CutCap::open) throw Error(facts::mesh::CapNeedsPlane{});
}

Points whole_normals(const Mesh& mesh, const DrawnCut& cut) {
  Mesh moved;
  moved.positions = cut.positions.topRows(mesh.vertex_count());
  moved.faces = mesh.faces;
  Points normals = vertex_normals(moved);
  normals.conservativeResize(cut.positions.rows(), 3);
  for (Eigen::Index v = mesh.vertex_count(); v < normals.rows(); ++v) {
    const EdgePoint& between = cut.origin[v];
    const Eigen::RowVector3d mean =
        (1 - between.t) * normals.row(between.from) + between.t * normals.row(between.to);
    normals.row(v) = mean.stableNorm() > 0 ? Eigen::RowVector3d(mean / mean.stableNorm()) : mean;
  }
  return normals;
}

CutResult separate(const Mesh& mesh, const DrawnCut& cut, CutKeep keep, const Context& context, bool* closed) {
  Separation separation(mesh, cut, keep, context);
  CutResult result = separation.run();
  if (closed != nullptr) *closed = separation.are_in_loops(result.loops);
  return result;
}

}  // namespace meshgraft
