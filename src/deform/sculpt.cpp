#include "sculpt.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include <Eigen/Eigenvalues>

#include <meshgraft/core/error.h>
#include <meshgraft/linalg/linear_solver.h>
#include <meshgraft/mesh/normals.h>
#include <meshgraft/mesh/topology.h>

#include "core/facts.h"
#include "deform/facts.h"
#include "linalg/sparse.h"
#include "mesh/edge_table.h"
#include "operators/laplacian.h"

namespace meshgraft {

namespace {

/// Holds the vertices that move and those of the two rings around them, numbered anew.
struct SculptPatch {
  std::vector<Index> vertex;  ///< numbers in the surface
  Points points;
  Triangles triangles;
  IndexLists rings;
  std::vector<Index> unknown;       ///< per vertex: index among the moving vertices, or -1
  std::vector<Index> moving;        ///< the moving vertices
  std::vector<Index> held;          ///< vertices at an open boundary, which would move elsewhere
  std::vector<double> from_region;  ///< with a reach: distances from the region along edges
};

void require_fraction(double strength) {
  if (!(strength >= 0 && strength <= 1))
    throw Error(facts::core::OutOfRange{.value = strength, .low = 0, .high = 1}, "strength");
}

void require_reach(double reach) {
  if (!(reach >= 0 && std::isfinite(reach)))
    throw Error(facts::core::NegativeOrNotFinite{.value = reach}, "reach");
}

// Returns each vertex's distance from the region along edges, infinity beyond the reach.
std::vector<double> distance_from_region(const SculptedSurface& surface, double reach) {
  const IndexLists rings = vertex_rings(static_cast<Index>(surface.points.rows()), surface.triangles);
  return edge_distance(surface.region, surface.points, rings, {.limit = reach});
}

Flags flag_region(const SculptedSurface& surface) {
  Flags is_meant(static_cast<std::size_t>(surface.points.rows()), 0);
  for (const Index v : surface.region) is_meant[v] = 1;
  return is_meant;
}

// Adds the corners of all triangles at the flagged vertices.
void add_ring(Flags& flags, const SculptedSurface& surface) {
  const Flags before = flags;
  for (Eigen::Index t = 0; t < surface.triangles.rows(); ++t) {
    const auto corners = surface.triangles.row(t);
    if (before[corners[0]] == 0 && before[corners[1]] == 0 && before[corners[2]] == 0) continue;
    for (const Index v : corners) flags[v] = 1;
  }
}

// Numbers the vertices that are meant to move and are not at an edge of one triangle.
void number_moving(SculptPatch& patch, const Flags& is_meant) {
  Flags is_border(patch.vertex.size(), 0);
  const auto lists = vertex_triangles(static_cast<Index>(patch.vertex.size()), patch.triangles);
  for (const TriangleEdge& edge : list_edges(patch.triangles, lists))
    if (edge.forward + edge.backward == 1)
      for (const Index v : edge.ends) is_border[v] = 1;
  patch.unknown.assign(patch.vertex.size(), -1);
  for (std::size_t v = 0; v < patch.vertex.size(); ++v) {
    if (is_meant[patch.vertex[v]] == 0 || patch.rings[static_cast<Index>(v)].empty()) continue;
    if (is_border[v] != 0) {
      patch.held.push_back(static_cast<Index>(v));
      continue;
    }
    patch.unknown[v] = static_cast<Index>(patch.moving.size());
    patch.moving.push_back(static_cast<Index>(v));
  }
}

// The edge of the patch lies beyond two rings, except where the surface itself ends.
SculptPatch make_sculpt_patch(const SculptedSurface& surface, std::optional<double> reach,
                              const Context& context) {
  const auto count = static_cast<std::size_t>(surface.points.rows());
  Flags is_meant = flag_region(surface);
  std::vector<double> distance;
  if (reach) {
    distance = distance_from_region(surface, *reach);
    for (std::size_t v = 0; v < count; ++v)
      if (distance[v] < *reach) is_meant[v] = 1;
  }
  Flags is_near = is_meant;
  add_ring(is_near, surface);
  add_ring(is_near, surface);
  context.throw_if_stopped();
  SculptPatch patch;
  std::vector<Index> number(count, -1);
  for (std::size_t v = 0; v < count; ++v) {
    if (is_near[v] == 0) continue;
    number[v] = static_cast<Index>(patch.vertex.size());
    patch.vertex.push_back(static_cast<Index>(v));
    if (reach) patch.from_region.push_back(distance[v]);
  }
  std::vector<Index> chosen;
  for (Eigen::Index t = 0; t < surface.triangles.rows(); ++t) {
    const auto corners = surface.triangles.row(t);
    if (number[corners[0]] >= 0 && number[corners[1]] >= 0 && number[corners[2]] >= 0)
      chosen.push_back(static_cast<Index>(t));
  }
  patch.points.resize(static_cast<Eigen::Index>(patch.vertex.size()), 3);
  for (std::size_t v = 0; v < patch.vertex.size(); ++v)
    patch.points.row(static_cast<Eigen::Index>(v)) = surface.points.row(patch.vertex[v]);
  patch.triangles.resize(static_cast<Eigen::Index>(chosen.size()), 3);
  for (std::size_t k = 0; k < chosen.size(); ++k)
    for (int c = 0; c < 3; ++c)
      patch.triangles(static_cast<Eigen::Index>(k), c) = number[surface.triangles(chosen[k], c)];
  patch.rings = vertex_rings(static_cast<Index>(patch.vertex.size()), patch.triangles);
  number_moving(patch, is_meant);
  return patch;
}

// Returns whether less than three vertices of some connected component are held.
bool moves_a_component(const SculptPatch& patch) {
  Flags is_seen(patch.vertex.size(), 0);
  for (const Index seed : patch.moving) {
    if (is_seen[seed] != 0) continue;
    int held = 0;
    std::vector<Index> waiting{seed};
    is_seen[seed] = 1;
    while (!waiting.empty()) {
      const Index v = waiting.back();
      waiting.pop_back();
      held += patch.unknown[v] < 0;
      for (const Index w : patch.rings[v]) {
        if (is_seen[w] != 0) continue;
        is_seen[w] = 1;
        waiting.push_back(w);
      }
    }
    if (held < 3) return true;
  }
  return false;
}

// Returns the surface with new positions of the moving vertices.
Points with_moved(const SculptedSurface& surface, const SculptPatch& patch, const Points& moved) {
  Points points = surface.points;
  for (const Index v : patch.moving) points.row(patch.vertex[v]) = moved.row(v);
  return points;
}

/// The rows M^{-1/2} K of a patch, and the areas M.
struct Bending {
  SparseRows rows;
  std::vector<double> areas;
};

Bending bending_of(const SculptPatch& patch, const Context& context) {
  Bending bending{dirichlet_matrix(patch.points, patch.triangles, patch.rings, context),
                  vertex_areas(patch.points, patch.triangles)};
  const double least = 1e-9 * *std::max_element(bending.areas.begin(), bending.areas.end());
  for (Eigen::Index i = 0; i < bending.rows.rows(); ++i) {
    double& area = bending.areas[static_cast<std::size_t>(i)];
    area = std::max(area, least);
    for (SparseRows::InnerIterator entry(bending.rows, i); entry; ++entry) entry.valueRef() /= std::sqrt(area);
  }
  return bending;
}

// Returns the rows that contain a moving vertex, and of these the columns of the moving vertices.
SparseRows columns_of_moving(const SparseRows& rows, const SculptPatch& patch) {
  std::vector<Eigen::Triplet<double>> entries;
  for (Eigen::Index i = 0; i < rows.rows(); ++i)
    for (SparseRows::InnerIterator entry(rows, i); entry; ++entry)
      if (const Index unknown = patch.unknown[entry.col()]; unknown >= 0)
        entries.emplace_back(static_cast<int>(i), unknown, entry.value());
  SparseRows columns(rows.rows(), static_cast<Eigen::Index>(patch.moving.size()));
  columns.setFromTriplets(entries.begin(), entries.end());
  return columns;
}

double area_of(const std::vector<Index>& vertices, const std::vector<double>& areas) {
  double sum = 0;
  for (const Index v : vertices) sum += areas[v];
  return sum;
}

// Returns whether there are moving vertices, and faces with an area at them.
bool has_area(const SculptPatch& patch) {
  return area_of(patch.moving, vertex_areas(patch.points, patch.triangles)) > 0;
}

// Rises from 0 to 1, level at both ends.
double smooth_step(double t) { return t * t * (3 - 2 * t); }

// Returns a weight per vertex: 0 outside, rising smoothly with the distance from what stays, 1 at `share` of
// the largest distance and beyond. 1 everywhere in components that move as a whole.
std::vector<double> profile_within(const SculptPatch& patch, double share) {
  std::vector<Index> still;
  for (std::size_t v = 0; v < patch.unknown.size(); ++v)
    if (patch.unknown[v] < 0) still.push_back(static_cast<Index>(v));
  const std::vector<double> depth = edge_distance(still, patch.points, patch.rings);
  double deepest = 0;
  for (const Index v : patch.moving)
    if (std::isfinite(depth[v])) deepest = std::max(deepest, depth[v]);
  std::vector<double> weights(depth.size(), 0);
  for (const Index v : patch.moving) {
    const double t = std::isfinite(depth[v]) ? std::min(1.0, depth[v] / (share * deepest)) : 1;
    weights[v] = smooth_step(t);
  }
  return weights;
}

// Returns a weight per vertex: 1 in the region, falling smoothly to 0 at the reach and at open boundaries.
// Towards boundaries it falls within the reach, or within the room that the region has if that is less, so that
// the vertices of the region that are farthest from a boundary always have the weight 1.
std::vector<double> profile_around(const SculptPatch& patch, double reach) {
  const std::vector<double> from_boundary = edge_distance(patch.held, patch.points, patch.rings);
  double room = 0;
  for (const Index v : patch.moving)
    if (patch.from_region[v] == 0) room = std::max(room, from_boundary[v]);
  const double fade = std::min(reach, room);
  std::vector<double> weights(patch.vertex.size(), 0);
  for (const Index v : patch.moving) {
    const double outward = patch.from_region[v] > 0 ? 1 - patch.from_region[v] / reach : 1,
                 inward = from_boundary[v] < fade ? from_boundary[v] / fade : 1;
    weights[v] = smooth_step(std::min(outward, inward));
  }
  return weights;
}

// Returns the vertices of the region that move.
std::vector<Index> moving_of_region(const SculptPatch& patch, const SculptedSurface& surface) {
  const Flags is_meant = flag_region(surface);
  std::vector<Index> moving;
  for (const Index v : patch.moving)
    if (is_meant[patch.vertex[v]] != 0) moving.push_back(v);
  return moving;
}

// Returns unit normals without the surface's detail: the vertex normals, diffused over a fraction of the
// size of what moves, so that vertices of noise do not move across each other.
Points broad_normals(const SculptPatch& patch, const Context& context) {
  constexpr double share = 0.15;  // chosen, × the square root of the area that moves
  const auto triangles = vertex_triangles(static_cast<Index>(patch.vertex.size()), patch.triangles);
  const Points normals = vertex_normals(patch.points, patch.triangles, triangles, context);
  const std::vector<double> areas = vertex_areas(patch.points, patch.triangles);
  const double length = share * std::sqrt(area_of(patch.moving, areas));
  const double least = 1e-9 * *std::max_element(areas.begin(), areas.end());
  auto lower =
      NormalMatrix((length * length * dirichlet_matrix(patch.points, patch.triangles, patch.rings, context))
                       .triangularView<Eigen::Lower>());
  Eigen::MatrixXd weighted(patch.points.rows(), 3);
  for (Eigen::Index v = 0; v < weighted.rows(); ++v) {
    const double area = std::max(areas[static_cast<std::size_t>(v)], least);
    lower.coeffRef(v, v) += area;
    weighted.row(v) = area * normals.row(v);
  }
  const auto solver = make_solver();
  solver->analyse(lower, {}, context);
  solver->factorise(lower, context);
  return solver->solve(weighted, context).rowwise().normalized();
}

}  // namespace

Points smooth_region(const SculptedSurface& surface, double strength, const Context& context) {
  require_fraction(strength);
  context.step("solve");
  const SculptPatch patch = make_sculpt_patch(surface, {}, context);
  if (strength == 0 || !has_area(patch)) return surface.points;
  if (strength == 1 && moves_a_component(patch)) throw Error(facts::deform::SmoothedAway{}, "strength");
  const Bending bending = bending_of(patch, context);
  const double length = std::sqrt(area_of(patch.moving, bending.areas)), wave = 2 * std::numbers::pi / length;
  const double attachment = std::pow(wave / strength, 4) - std::pow(wave, 4);
  const SparseRows rows = columns_of_moving(bending.rows, patch), columns = transpose(rows, context);
  auto lower = NormalMatrix(multiply(columns, rows, context).triangularView<Eigen::Lower>());
  for (std::size_t k = 0; k < patch.moving.size(); ++k)
    lower.coeffRef(static_cast<Eigen::Index>(k), static_cast<Eigen::Index>(k)) +=
        attachment * bending.areas[patch.moving[k]];
  const auto solver = make_solver();
  solver->analyse(lower, {}, context);
  solver->factorise(lower, context);
  const Eigen::RowVector3d middle = patch.points.colwise().mean();
  const Columns bent = multiply(bending.rows, Columns(patch.points.rowwise() - middle), context);
  const Eigen::MatrixXd moves = solver->solve(-multiply(columns, bent, context), context);
  Points moved = patch.points;
  for (std::size_t k = 0; k < patch.moving.size(); ++k)
    moved.row(patch.moving[k]) += moves.row(static_cast<Eigen::Index>(k));
  return with_moved(surface, patch, moved);
}

std::vector<Index> vertices_within(const SculptedSurface& surface, std::optional<double> reach) {
  std::vector<Index> vertices(surface.region.begin(), surface.region.end());
  if (!reach || vertices.empty()) return vertices;
  const std::vector<double> distance = distance_from_region(surface, *reach);
  vertices.clear();
  for (std::size_t v = 0; v < distance.size(); ++v)
    if (std::isfinite(distance[v])) vertices.push_back(static_cast<Index>(v));
  return vertices;
}

std::vector<Index> with_rings_read(const SculptedSurface& surface, std::span<const Index> vertices) {
  Flags is_read(static_cast<std::size_t>(surface.points.rows()), 0);
  for (const Index v : vertices) is_read[v] = 1;
  add_ring(is_read, surface);
  add_ring(is_read, surface);
  std::vector<Index> read;
  for (std::size_t v = 0; v < is_read.size(); ++v)
    if (is_read[v] != 0) read.push_back(static_cast<Index>(v));
  return read;
}

std::vector<double> reach_weights(const SculptedSurface& surface, double reach) {
  require_reach(reach);
  const SculptPatch patch = make_sculpt_patch(surface, reach, {});
  const std::vector<double> of_patch = profile_around(patch, reach);
  std::vector<double> weights(static_cast<std::size_t>(surface.points.rows()), 0);
  for (std::size_t v = 0; v < of_patch.size(); ++v) weights[patch.vertex[v]] = of_patch[v];
  return weights;
}

Points inflate_region(const SculptedSurface& surface, double height, std::optional<double> reach,
                      const Context& context) {
  if (reach) require_reach(*reach);
  const SculptPatch patch = make_sculpt_patch(surface, reach, context);
  if (!has_area(patch) || (reach && moving_of_region(patch, surface).empty())) return surface.points;
  const std::vector<double> weights = reach ? profile_around(patch, *reach) : profile_within(patch, 1);
  const Points normals = broad_normals(patch, context);
  Points moved = patch.points;
  for (const Index v : patch.moving) moved.row(v) += height * weights[v] * normals.row(v);
  return with_moved(surface, patch, moved);
}

Points flatten_region(const SculptedSurface& surface, double strength, std::optional<double> reach,
                      const Context& context) {
  require_fraction(strength);
  if (reach) require_reach(*reach);
  const SculptPatch patch = make_sculpt_patch(surface, reach, context);
  const std::vector<double> areas = vertex_areas(patch.points, patch.triangles);
  const std::vector<Index> flattened = reach ? moving_of_region(patch, surface) : patch.moving;
  const double area = area_of(flattened, areas);
  if (!(area > 0)) return surface.points;
  constexpr double share = 0.4;  // chosen: the middle is flat, and a rim leads over to the surface around it
  const std::vector<double> weights = reach ? profile_around(patch, *reach) : profile_within(patch, share);
  Eigen::RowVector3d centre = Eigen::RowVector3d::Zero();
  for (const Index v : flattened) centre += areas[v] * patch.points.row(v);
  centre /= area;
  Eigen::Matrix3d spread = Eigen::Matrix3d::Zero();
  for (const Index v : flattened) {
    const Eigen::RowVector3d arm = patch.points.row(v) - centre;
    spread += areas[v] * arm.transpose() * arm;
  }
  const Eigen::RowVector3d normal =
      Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(spread).eigenvectors().col(0).transpose();
  Points moved = patch.points;
  for (const Index v : patch.moving)
    moved.row(v) -= strength * weights[v] * (patch.points.row(v) - centre).dot(normal) * normal;
  return with_moved(surface, patch, moved);
}

}  // namespace meshgraft
