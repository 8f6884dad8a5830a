#include "cut_snap.h"

#include <algorithm>
#include <cmath>
#include <tuple>

#include <Eigen/Geometry>

#include "mesh/edge_table.h"
#include "mesh/fans.h"

namespace meshgraft {

namespace {

constexpr double least_turn_cos = 0.5;   // of the angle between a face's normals before and after a move
constexpr double least_shape_rel = 0.3;  // × the shape (area over longest edge squared) before the move

struct Move {
  double distance = 0;
  Index vertex = 0, towards = 0;
  double t = 0;
};

class Snap {
 public:
  Snap(const Faces& faces, Points& positions, std::vector<EdgePoint>& origin, std::vector<double>& values,
       const Context& context)
      : faces_(faces),
        positions_(positions),
        origin_(origin),
        values_(values),
        table_(static_cast<Index>(positions.rows()), faces, context),
        around_(faces, static_cast<Index>(positions.rows())) {
    context.throw_if_stopped();
    Mesh mesh;
    mesh.positions = positions;
    mesh.faces = faces;
    fans_ = fan_counts(mesh, table_);
    context.throw_if_stopped();
  }

  void run(double snap) {
    for (const Move& move : moves(snap)) {
      if (values_[move.vertex] == 0 || values_[move.towards] == 0) continue;
      const Eigen::RowVector3d target =
          (1 - move.t) * positions_.row(move.vertex) + move.t * positions_.row(move.towards);
      if (!around_.keep_shape(move.vertex, target, positions_) || !keeps_cut(move.vertex)) continue;
      positions_.row(move.vertex) = target;
      origin_[move.vertex] = {move.vertex, move.towards, move.t};
      values_[move.vertex] = 0;
    }
  }

 private:
  std::vector<Move> moves(double snap) const {
    std::vector<Move> found;
    for (Index e = 0; e < table_.edge_count(); ++e) {
      const auto [a, b] = table_.ends[e];
      if (!opposite(values_[a], values_[b])) continue;
      const double t = crossing(values_[a], values_[b]);
      const double length = (positions_.row(a) - positions_.row(b)).norm();
      const bool boundary = table_.half_edges[e].size() == 1;
      const Move move = t < 0.5 ? Move{t * length, a, b, t} : Move{(1 - t) * length, b, a, 1 - t};
      if (move.t < snap && (boundary || !on_boundary(move.vertex))) found.push_back(move);
    }
    std::sort(found.begin(), found.end(), [](const Move& a, const Move& b) {
      return std::tie(a.distance, a.vertex, a.towards) < std::tie(b.distance, b.vertex, b.towards);
    });
    return found;
  }

  bool on_boundary(Index vertex) const {
    for (const Index c : around_.corners(vertex))
      if (table_.next[c] >= 0 && (table_.is_boundary(c) || table_.is_boundary(table_.previous[c]))) return true;
    return false;
  }

  // Returns whether the cut, with the vertex on it, still passes the vertex once, from one side of its fan of
  // faces to the other. This keeps loops from meeting in the vertex or vanishing, and faces from lying in the
  // cut.
  bool keeps_cut(Index vertex) {
    if (fans_[vertex] != 1) return false;
    const double rest = values_[vertex];
    values_[vertex] = 0;
    const int passes = passes_through(vertex);
    values_[vertex] = rest;
    return passes == (on_boundary(vertex) ? 1 : 2);
  }

  // Counts how often the cut leaves a vertex that lies on it. Returns -1 if a face lies in the cut or an edge
  // has more than two faces.
  int passes_through(Index vertex) const {
    int passes = 0;
    for (const Index c : around_.corners(vertex)) {
      if (table_.next[c] < 0) return -1;
      const Side side = side_of(around_.face(c));
      if (side == 0) return -1;
      if (side == crossed) ++passes;
      for (const Index half_edge : {c, table_.previous[c]}) {
        const auto along = table_.half_edges[table_.edge[half_edge]];
        const Index end = half_edge == c ? faces_.corners()[table_.next[c]] : faces_.corners()[half_edge];
        if (along.size() > 2) return -1;
        if (along.size() < 2 || values_[end] != 0 || along[0] != half_edge) continue;
        if (side_of(around_.face(along[0])) * side_of(around_.face(along[1])) == -1) ++passes;
      }
    }
    return passes;
  }

  static constexpr Side crossed = 2;

  Side side_of(Index face) const {
    bool above = false, below = false;
    for (const Index v : faces_[face]) {
      above = above || values_[v] > 0;
      below = below || values_[v] < 0;
    }
    if (above && below) return crossed;
    return above ? 1 : below ? -1 : 0;
  }

  const Faces& faces_;
  Points& positions_;
  std::vector<EdgePoint>& origin_;
  std::vector<double>& values_;
  const EdgeTable table_;
  const FacesAround around_;
  std::vector<Index> fans_;  // per vertex
};

}  // namespace

struct FacesAround::FaceShape {
  Eigen::Vector3d area = Eigen::Vector3d::Zero();  // normal, as long as twice the area
  double longest_squared = 0;
};

FacesAround::FacesAround(const Faces& faces, Index vertex_count) : faces_(faces) {
  for (Index f = 0; f < faces.size(); ++f) face_.insert(face_.end(), faces[f].size(), f);
  corners_at_.offsets.assign(static_cast<std::size_t>(vertex_count) + 1, 0);
  for (const Index v : faces.corners()) ++corners_at_.offsets[v + 1];
  for (Index v = 0; v < vertex_count; ++v) corners_at_.offsets[v + 1] += corners_at_.offsets[v];
  corners_at_.values.resize(faces.corners().size());
  std::vector<Index> cursor(corners_at_.offsets.begin(), corners_at_.offsets.end() - 1);
  for (Index c = 0; c < faces.corner_count(); ++c) corners_at_.values[cursor[faces.corners()[c]]++] = c;
}

FacesAround::FaceShape FacesAround::shape(Index face, Index moved, const Eigen::RowVector3d& target,
                                          const Points& positions) const {
  FaceShape result;
  const auto corners = faces_[face];
  const auto at = [&](Index v) -> Eigen::RowVector3d { return v == moved ? target : positions.row(v); };
  const Eigen::RowVector3d first = at(corners[0]);
  for (std::size_t c = 0; c < corners.size(); ++c) {
    const Eigen::RowVector3d p = at(corners[c]), q = at(corners[(c + 1) % corners.size()]);
    result.area += Eigen::Vector3d(p - first).cross(Eigen::Vector3d(q - first));
    result.longest_squared = std::max(result.longest_squared, (p - q).squaredNorm());
  }
  return result;
}

bool FacesAround::keep_shape(Index vertex, const Eigen::RowVector3d& target, const Points& positions) const {
  for (const Index c : corners(vertex)) {
    const FaceShape before = shape(face_[c], vertex, positions.row(vertex), positions);
    const FaceShape after = shape(face_[c], vertex, target, positions);
    const double area_before = before.area.norm(), area_after = after.area.norm();
    if (!(after.area.dot(before.area) > least_turn_cos * area_after * area_before)) return false;
    if (!(area_after * before.longest_squared > least_shape_rel * area_before * after.longest_squared))
      return false;
  }
  return true;
}

double crossing(double value_a, double value_b) { return 1 / (1 - value_b / value_a); }

void snap_to_cut(const Faces& faces, double snap, Points& positions, std::vector<EdgePoint>& origin,
                 std::vector<double>& values, const Context& context) {
  Snap(faces, positions, origin, values, context).run(snap);
}

}  // namespace meshgraft
