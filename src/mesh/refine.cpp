#include "refine.h"

#include <utility>

#include <meshgraft/core/error.h>

#include "core/facts.h"
#include "edge_table.h"
#include "traced_faces.h"

namespace meshgraft {

namespace {

// Returns the midpoint of two elements.
EdgePoint midpoint_of(Index a, Index b) { return {a, b, 0.5}; }

Flags mark(Index vertex_count, std::span<const Index> vertices) {
  Flags marked(vertex_count, false);
  for (const Index v : vertices) {
    if (v < 0 || v >= vertex_count) throw Error(facts::core::NoSuchVertex{.vertex = v, .count = vertex_count});
    marked[v] = true;
  }
  return marked;
}

bool has_split_edge(const Mesh& mesh, Index face, const EdgeTable& table, const EdgePredicate& is_split) {
  for (Index c = mesh.faces.first_corner(face); c < mesh.faces.first_corner(face + 1); ++c) {
    if (table.next[c] < 0) continue;
    const auto& [a, b] = table.ends[table.edge[c]];
    if (is_split(a, b)) return true;
  }
  return false;
}

// One triangle with its split edges; corner c is followed by the midpoint of its edge to corner c + 1.
struct Piece {
  std::array<Index, 6> vertex;  // corners 0 1 2, then the midpoints of 01, 12, 20 (-1: not split)
  std::array<EdgePoint, 6> corner;
};

void emit(const Piece& piece, std::initializer_list<std::array<int, 3>> triangles, Index origin,
          TracedFaces& out) {
  for (const auto& [a, b, c] : triangles) {
    out.add(std::array{piece.vertex[a], piece.vertex[b], piece.vertex[c]},
            std::array{piece.corner[a], piece.corner[b], piece.corner[c]}, origin);
  }
}

// Rotates the corners so that corner `first` comes first.
Piece turned(const Piece& piece, int first) {
  Piece result = piece;
  for (int c = 0; c < 3; ++c) {
    for (const int half : {0, 3}) {
      result.vertex[half + c] = piece.vertex[half + (first + c) % 3];
      result.corner[half + c] = piece.corner[half + (first + c) % 3];
    }
  }
  return result;
}

void subdivide(Piece piece, const Points& positions, Index origin, TracedFaces& out) {
  int splits = 0;
  for (int k = 3; k < 6; ++k) splits += piece.vertex[k] >= 0;
  const auto length = [&](int a, int b) {
    return (positions.row(piece.vertex[a]) - positions.row(piece.vertex[b])).norm();
  };
  if (splits == 3) {
    emit(piece, {{0, 3, 5}, {3, 1, 4}, {5, 4, 2}, {3, 4, 5}}, origin, out);
  } else if (splits == 2) {
    while (piece.vertex[5] >= 0) piece = turned(piece, 1);  // edge 20 is the unsplit one
    emit(piece, {{3, 1, 4}}, origin, out);
    constexpr double rounding = 1e-9;  // of equal diagonals, one is taken whatever the pose of the mesh
    if (length(0, 4) < (1 - rounding) * length(2, 3)) {
      emit(piece, {{0, 3, 4}, {0, 4, 2}}, origin, out);
    } else {
      emit(piece, {{0, 3, 2}, {3, 4, 2}}, origin, out);
    }
  } else {
    while (piece.vertex[3] < 0) piece = turned(piece, 1);  // edge 01 is the split one
    emit(piece, {{0, 3, 2}, {3, 1, 2}}, origin, out);
  }
}

}  // namespace

RefineResult split_edges_within(const Mesh& mesh, std::span<const Index> vertices, const Context& context) {
  const Flags marked = mark(mesh.vertex_count(), vertices);
  return split_edges(mesh, [&](Index a, Index b) { return marked[a] && marked[b]; }, context);
}

RefineResult split_edges_at(const Mesh& mesh, std::span<const Index> vertices, const Context& context) {
  const Flags marked = mark(mesh.vertex_count(), vertices);
  return split_edges(mesh, [&](Index a, Index b) { return marked[a] || marked[b]; }, context);
}

RefineResult split_edges(const Mesh& mesh, const EdgePredicate& is_split, const Context& context) {
  context.step("refine", 0);
  const Index old_count = mesh.vertex_count();
  const EdgeTable polygon_edges(old_count, mesh.faces, context);
  const TracedFaces coarse =
      triangulate_chosen(mesh, [&](Index f) { return has_split_edge(mesh, f, polygon_edges, is_split); },
                         {.skip_out_of_range = true});
  const EdgeTable table(old_count, coarse.faces, context);

  context.step("refine", 0.3);
  RefineResult result;
  std::vector<Index> middle(table.edge_count(), -1);
  for (Index e = 0; e < table.edge_count(); ++e) {
    if (!is_split(table.ends[e][0], table.ends[e][1])) continue;
    middle[e] = old_count + static_cast<Index>(result.parents.size());
    result.parents.push_back(table.ends[e]);
  }
  std::vector<EdgePoint> vertex_origin;
  for (Index v = 0; v < old_count; ++v) vertex_origin.push_back(same(v));
  for (const auto& [a, b] : result.parents) vertex_origin.push_back(midpoint_of(a, b));
  result.vertex.new_index.resize(old_count);
  for (Index v = 0; v < old_count; ++v) result.vertex.new_index[v] = v;

  Points& positions = result.mesh.positions;
  positions.resize(static_cast<Eigen::Index>(vertex_origin.size()), 3);
  positions.topRows(old_count) = mesh.positions;
  for (std::size_t k = 0; k < result.parents.size(); ++k) {
    const auto& [a, b] = result.parents[k];
    positions.row(old_count + static_cast<Eigen::Index>(k)) =
        0.5 * mesh.positions.row(a) + 0.5 * mesh.positions.row(b);
  }

  context.step("refine", 0.5);
  TracedFaces fine;
  for (Index f = 0; f < coarse.faces.size(); ++f) {
    const auto face = coarse.faces[f];
    const Index first = coarse.faces.first_corner(f);
    const std::span<const EdgePoint> corners(coarse.corner_origin.data() + first, face.size());
    Piece piece{};
    bool split = false;
    for (int c = 0; face.size() == 3 && c < 3; ++c) {
      const Index half_edge = first + c;
      if (table.next[half_edge] < 0) break;
      piece.vertex[c] = face[c];
      piece.corner[c] = corners[c];
      piece.vertex[3 + c] = middle[table.edge[half_edge]];
      piece.corner[3 + c] = midpoint_of(corners[c].from, corners[(c + 1) % 3].from);
      split = split || piece.vertex[3 + c] >= 0;
    }
    if (split) {
      subdivide(piece, positions, coarse.face_origin[f], fine);
    } else {
      fine.add(face, corners, coarse.face_origin[f]);
    }
  }

  context.step("refine", 0.8);
  result.mesh.source = mesh.source;  // a writer uses the data that does not depend on the topology
  result.face_parent = fine.face_origin;
  std::vector<EdgePoint> face_origin;
  for (const Index f : fine.face_origin) face_origin.push_back(same(f));
  for (const Attribute& attribute : mesh.attributes) {
    const auto& origins = attribute.domain == Domain::vertex ? vertex_origin
                          : attribute.domain == Domain::face ? face_origin
                                                             : fine.corner_origin;
    result.mesh.attributes.push_back(interpolate_attribute(attribute, origins));
  }
  result.mesh.faces = std::move(fine.faces);
  context.step("refine", 1);
  return result;
}

}  // namespace meshgraft
