#include "base_side.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numbers>
#include <numeric>

#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>

#include "mesh/area_vector.h"
#include "mesh/box_diagonal.h"
#include "mesh/edge_table.h"
#include "mesh/up_axis.h"
#include "mesh/winding.h"

namespace meshgraft {

namespace {

using Direction = Eigen::Vector3d;

/// A plane in which a source ends.
struct FlatSide {
  Direction outward;
  double offset = 0, area = 0;
};

const double same_direction = std::cos(3 * std::numbers::pi / 180);  // chosen
constexpr double in_plane = 0.005;                                   // chosen, × the diagonal

/// Grows a connected patch of faces that lie in the plane of the face `seed`.
FlatSide grow_patch(Index seed, const Mesh& surface, const EdgeTable& table, const Points& normals,
                    double slack, Flags& seen) {
  const Direction normal = normals.row(seed).transpose().normalized();
  const double offset = surface.positions.row(surface.faces[seed][0]).dot(normal);
  FlatSide patch{Direction::Zero(), 0, 0};
  double highest = offset;
  std::vector<Index> waiting{seed};
  seen[seed] = true;
  while (!waiting.empty()) {
    const Index face = waiting.back();
    waiting.pop_back();
    const double twice_area = normals.row(face).norm();
    patch.outward += normals.row(face).transpose();
    patch.area += twice_area / 2;
    for (const Index v : surface.faces[face]) highest = std::max(highest, surface.positions.row(v).dot(normal));
    for (Index c = 3 * face; c < 3 * face + 3; ++c) {
      if (table.edge[c] < 0) continue;
      for (const Index half_edge : table.half_edges[table.edge[c]]) {
        const Index other = half_edge / 3;
        if (seen[other]) continue;
        const bool level = normals.row(other).dot(normal) >= same_direction * normals.row(other).norm();
        const auto corners = surface.faces[other];
        const bool inside = std::all_of(corners.begin(), corners.end(), [&](Index v) {
          return std::abs(surface.positions.row(v).dot(normal) - offset) <= slack;
        });
        if (!level || !inside) continue;
        seen[other] = true;
        waiting.push_back(other);
      }
    }
  }
  patch.outward.normalize();
  patch.offset = highest;
  return patch;
}

/// Returns the planes in which the source ends, with the areas of all its faces in them, the largest first.
std::vector<FlatSide> flat_sides(const Mesh& surface, double orientation, double diagonal) {
  constexpr double least_patch = 5e-4;  // chosen, × the square of the diagonal
  const double slack = in_plane * diagonal;
  Points normals(surface.face_count(), 3);
  for (Index f = 0; f < surface.face_count(); ++f)
    normals.row(f) = orientation * area_vector(surface.faces[f], surface.positions).transpose();
  std::vector<Index> order(surface.face_count());
  std::iota(order.begin(), order.end(), Index{0});
  std::stable_sort(order.begin(), order.end(),
                   [&](Index a, Index b) { return normals.row(a).norm() > normals.row(b).norm(); });
  const EdgeTable table(surface.vertex_count(), surface.faces);
  Flags seen(surface.face_count(), false);
  std::vector<FlatSide> sides;
  for (const Index seed : order) {
    if (seen[seed] || !(normals.row(seed).norm() > 0)) continue;
    const FlatSide patch = grow_patch(seed, surface, table, normals, slack, seen);
    if (patch.area < least_patch * diagonal * diagonal) continue;
    const double farthest = (surface.positions * patch.outward).maxCoeff();
    if (farthest > patch.offset + slack) continue;
    const auto same = std::find_if(sides.begin(), sides.end(), [&](const FlatSide& side) {
      return side.outward.dot(patch.outward) >= same_direction && std::abs(side.offset - patch.offset) <= slack;
    });
    if (same != sides.end())
      same->area += patch.area;
    else
      sides.push_back(patch);
  }
  std::stable_sort(sides.begin(), sides.end(),
                   [](const FlatSide& a, const FlatSide& b) { return a.area > b.area; });
  return sides;
}

Direction longest_extent(const Points& points) {
  const Eigen::RowVector3d mean = points.colwise().mean();
  const Points centred = points.rowwise() - mean;
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> spread(centred.transpose() * centred);
  return spread.eigenvectors().col(2);
}

}  // namespace

std::vector<BaseSide> base_sides(const Mesh& source) {
  constexpr double least_lowest = 0.002, least_other = 0.01;  // chosen, × the square of the diagonal
  const double downward = std::cos(15 * std::numbers::pi / 180);
  const Mesh surface = make_mesh(source.positions, triangulate(source, {.skip_out_of_range = true}).triangles);
  const double diagonal = box_diagonal_of_faces(source), square = diagonal * diagonal;
  const Direction up = up_axis_of(source) == UpAxis::y ? Direction::UnitY() : Direction::UnitZ();
  std::vector<FlatSide> flat = flat_sides(surface, enclosed_volume(source) < 0 ? -1 : 1, diagonal);
  std::vector<BaseSide> sides;
  const auto add = [&](const Direction& direction, bool is_flat, bool is_lowest = false) {
    for (const BaseSide& side : sides)
      if (side.up.dot(direction) > same_direction) return;
    sides.push_back({direction, is_flat, is_lowest});
  };
  for (const FlatSide& side : flat)
    if (-side.outward.dot(up) > downward && side.area > least_lowest * square) add(-side.outward, true);
  for (const FlatSide& side : flat)
    if (side.area > least_other * square) add(-side.outward, true);
  add(up, false, true);
  const Direction longest = longest_extent(source.positions);
  add(longest, false);
  add(-longest, false);
  for (Eigen::Index axis = 0; axis < 3; ++axis)
    for (const double sign : {1.0, -1.0}) add(sign * Direction::Unit(axis), false);
  return sides;
}

}  // namespace meshgraft
