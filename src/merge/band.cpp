#include "band.h"

#include <algorithm>
#include <cmath>

#include <meshgraft/linalg/linear_solver.h>
#include <meshgraft/linalg/sparse.h>
#include <meshgraft/mesh/topology.h>
#include <meshgraft/operators/laplacian.h>

namespace meshgraft {

namespace {

// How far each vertex follows its neighbours: 1 beside the strip, fading out with the rings; 0 where it stays.
std::vector<double> mobility(const SeamPatch& patch, const IndexLists& rings, const SeamOptions& options) {
  std::vector<bool> held = patch.on_border;
  for (const SeamEdge& edge : inner_edges(patch)) {
    if (edge.dihedral_deg <= options.sharp_angle_deg) continue;
    if (patch.side[edge.triangles[0]] != SeamSide::target || patch.side[edge.triangles[1]] != SeamSide::target)
      continue;
    for (const Index v : edge.ends) held[v] = true;
  }

  // Ring by ring from the strip, never past a vertex that is held.
  std::vector<double> result(patch.vertex.size(), 0);
  const auto limit = [&](Index v) {
    return patch.of[v] == SeamSide::target ? options.target_rings : options.source_rings;
  };
  for (int r = 1; r <= std::max(options.target_rings, options.source_rings); ++r) {
    for (std::size_t k = 0; k < result.size(); ++k) {
      const auto v = static_cast<Index>(k);
      if (patch.ring[k] != r || held[k] || r > limit(v)) continue;
      const auto beside = rings[v];
      const bool reached = r == 1 || std::any_of(beside.begin(), beside.end(), [&](Index w) {
                             return patch.ring[w] == r - 1 && patch.of[w] == patch.of[v] && result[w] > 0;
                           });
      if (reached) result[k] = 1 - (r - 1.0) / limit(v);
    }
  }
  return result;
}

// Vectors of mean curvature: (S x)_i / m_i.
Columns curvature(const SparseRows& stiffness, const std::vector<double>& areas, const Points& points) {
  Columns result = multiply(stiffness, points);
  for (Eigen::Index i = 0; i < result.rows(); ++i) result.row(i) /= areas[i];
  return result;
}

// The curvature that the band should have: what each surface brings along, and between them, on the strip,
// its harmonic continuation from both sides.
Columns continued_curvature(const SeamPatch& patch, const IndexLists& rings, const std::vector<bool>& is_known,
                            Columns known) {
  constexpr int sweeps = 200;
  for (std::size_t k = 0; k < is_known.size(); ++k) {
    if (!is_known[k]) known.row(static_cast<Eigen::Index>(k)).setZero();
  }
  for (int sweep = 0; sweep < sweeps; ++sweep) {
    for (std::size_t k = 0; k < is_known.size(); ++k) {
      if (is_known[k]) continue;
      const auto v = static_cast<Index>(k);
      Eigen::RowVector3d sum = Eigen::RowVector3d::Zero();
      for (const Index w : rings[v]) sum += known.row(w);
      known.row(v) = sum / static_cast<double>(rings[v].size());
    }
  }
  return known;
}

// Moves the free vertices so that the curvature comes nearest to the wanted one:
// min over x of sum over rows of m_i |(S x)_i / m_i - t_i|^2 (Botsch and Kobbelt 2004, with details).
void fair(Points& points, const SeamPatch& patch, const IndexLists& rings, const std::vector<Index>& column,
          const std::vector<bool>& has_row, const Columns& wanted, const Context& context) {
  const SparseRows stiffness = dirichlet_matrix(points, patch.triangles, rings, context);
  const std::vector<double> areas = vertex_areas(points, patch.triangles);
  Index unknowns = 0;
  for (const Index c : column) unknowns = std::max(unknowns, c + 1);
  std::vector<Eigen::Triplet<double>> entries;
  Columns rhs = Columns::Zero(points.rows(), 3);
  for (Eigen::Index i = 0; i < points.rows(); ++i) {
    if (!has_row[i]) continue;
    const double root = std::sqrt(areas[i]);
    rhs.row(i) = root * wanted.row(i);
    for (SparseRows::InnerIterator entry(stiffness, i); entry; ++entry) {
      if (column[entry.col()] >= 0) {
        entries.emplace_back(static_cast<int>(i), column[entry.col()], entry.value() / root);
      } else {
        rhs.row(i) -= entry.value() / root * points.row(entry.col());
      }
    }
  }
  SparseRows rows(static_cast<int>(points.rows()), unknowns);
  rows.setFromTriplets(entries.begin(), entries.end());
  const SparseRows columns = transpose(rows);
  const NormalMatrix normal = NormalMatrix(multiply(columns, rows, context).triangularView<Eigen::Lower>());
  const auto solver = make_solver();
  solver->analyse(normal, context);
  solver->factorise(normal, context);
  const Eigen::MatrixXd solution = solver->solve(multiply(columns, rhs, context), context);
  for (std::size_t k = 0; k < column.size(); ++k) {
    if (column[k] >= 0) points.row(static_cast<Eigen::Index>(k)) = solution.row(column[k]);
  }
}

}  // namespace

std::vector<Index> smooth_band(Mesh& mesh, const SeamLayout& layout, const SeamOptions& options,
                               const Context& context) {
  const SeamPatch patch =
      make_seam_patch(mesh, layout, std::max(options.target_rings, options.source_rings) + 1);
  const IndexLists rings = vertex_rings(static_cast<Index>(patch.vertex.size()), patch.triangles);
  const std::vector<double> weights = mobility(patch, rings, options);
  const std::size_t count = weights.size();

  std::vector<Index> column(count, -1);
  Index unknowns = 0;
  for (std::size_t k = 0; k < count; ++k) {
    if (weights[k] > 0) column[k] = unknowns++;
  }
  if (unknowns == 0) return {};
  std::vector<bool> has_row(count, false), is_known(count, false);
  for (std::size_t k = 0; k < count; ++k) {
    const auto ring = rings[static_cast<Index>(k)];
    is_known[k] = patch.ring[k] > 1;
    has_row[k] = !patch.on_border[k] &&
                 (column[k] >= 0 || std::any_of(ring.begin(), ring.end(), [&](Index w) { return column[w] >= 0; }));
  }
  Points points = patch.points;
  const Columns wanted = continued_curvature(
      patch, rings, is_known,
      curvature(dirichlet_matrix(points, patch.triangles, rings), vertex_areas(points, patch.triangles), points));
  for (int step = 0; step < options.smoothing_steps; ++step) {
    context.throw_if_stopped();
    fair(points, patch, rings, column, has_row, wanted, context);
  }

  std::vector<Index> band;
  for (std::size_t k = 0; k < weights.size(); ++k) {
    if (weights[k] == 0) continue;
    band.push_back(patch.vertex[k]);
    mesh.positions.row(patch.vertex[k]) = points.row(static_cast<Eigen::Index>(k));
  }
  return band;
}

}  // namespace meshgraft
