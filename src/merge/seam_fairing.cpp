#include "seam_fairing.h"

#include <algorithm>
#include <cmath>
#include <string>

#include <meshgraft/core/error.h>
#include <meshgraft/linalg/linear_solver.h>
#include <meshgraft/mesh/normals.h>
#include <meshgraft/mesh/topology.h>

#include "linalg/sparse.h"
#include "merge/facts.h"
#include "operators/laplacian.h"
#include "reduce_folds.h"
#include "seam_relaxation.h"
#include "umbrella_smoothing.h"

namespace meshgraft {

namespace {

// The patch, with the role of each of its vertices in the band.
struct Band {
  SeamPatch patch;
  IndexLists rings;
  IndexLists triangles;       // per vertex
  Flags is_sharp;             // on a sharp edge of the target or of the source
  std::vector<Index> column;  // per vertex: index of its unknown, or -1 where it is fixed
  Index unknowns = 0;
};

Flags on_sharp_edges(const SeamPatch& patch, double sharp_angle_deg) {
  Flags sharp(patch.vertex.size(), false);
  for (const SeamEdge& edge : inner_edges(patch)) {
    if (edge.dihedral_deg <= sharp_angle_deg) continue;
    const bool of_strip =
        patch.side[edge.triangles[0]] == SeamSide::strip || patch.side[edge.triangles[1]] == SeamSide::strip;
    if (of_strip) continue;
    for (const Index v : edge.ends) sharp[v] = true;
  }
  return sharp;
}

// Numbers the vertices that may move, ring by ring from the strip, on each side up to its number of rings. On
// the target they never lie beyond a sharp edge.
void number_free_vertices(Band& band, const SeamOptions& options) {
  const SeamPatch& patch = band.patch;
  band.column.assign(patch.vertex.size(), -1);
  const auto limit = [&](Index v) {
    return patch.of[v] == SeamSide::target ? options.target_rings : options.source_rings;
  };
  for (int r = 1; r <= std::max(options.target_rings, options.source_rings); ++r) {
    for (Index v = 0; v < static_cast<Index>(band.column.size()); ++v) {
      if (patch.ring[v] != r || r > limit(v) || patch.on_border[v]) continue;
      if (patch.of[v] == SeamSide::target && band.is_sharp[v]) continue;
      const auto inner_and_free = [&](Index w) {
        return patch.ring[w] == r - 1 && patch.of[w] == patch.of[v] && band.column[w] >= 0;
      };
      const auto beside = band.rings[v];
      if (r == 1 || std::any_of(beside.begin(), beside.end(), inner_and_free)) band.column[v] = band.unknowns++;
    }
  }
}

Band make_band(const Mesh& mesh, const SeamLayout& layout, const SeamOptions& options) {
  Band band;
  band.patch = make_seam_patch(mesh, layout, std::max(options.target_rings, options.source_rings) + 1);
  band.triangles = vertex_triangles(static_cast<Index>(band.patch.vertex.size()), band.patch.triangles);
  band.rings = vertex_rings(band.patch.triangles, band.triangles);
  band.is_sharp = on_sharp_edges(band.patch, options.sharp_angle_deg);
  number_free_vertices(band, options);
  return band;
}

// Returns the patch's vertices that may move, ascending.
std::vector<Index> moving_vertices(const Band& band) {
  std::vector<Index> moving;
  for (Index v = 0; v < static_cast<Index>(band.column.size()); ++v)
    if (band.column[v] >= 0) moving.push_back(v);
  return moving;
}

// Differential quantities of the surface for given vertex positions.
struct Shape {
  Points normals;        // n×3, unit
  SparseRows stiffness;  // n×n, cotangent weights
  std::vector<double> areas;
  Eigen::VectorXd curvature;  // n, twice the mean curvature: n_i · (S x)_i / m_i

  Shape(const Band& band, const Points& points, const Context& context)
      : normals(vertex_normals(points, band.patch.triangles, band.triangles, context)),
        stiffness(dirichlet_matrix(points, band.patch.triangles, band.rings, context)),
        areas(vertex_areas(points, band.patch.triangles)),
        curvature((multiply(stiffness, points).array() * normals.array()).rowwise().sum()) {
    for (Eigen::Index i = 0; i < curvature.size(); ++i) {
      if (areas[i] > 0) curvature[i] /= areas[i];
    }
  }
};

// Returns the wanted curvature of the band: that of each surface and, on the strips' vertices, its harmonic
// continuation from both sides. Sharp edges keep their curvature and do not contribute to that of their
// neighbours.
Eigen::VectorXd continued_curvature(const Band& band, Eigen::VectorXd curvature) {
  constexpr int sweeps = 200;
  std::vector<Index> on_strip;
  for (Index v = 0; v < static_cast<Index>(band.column.size()); ++v) {
    if (band.patch.ring[v] == 1 && !band.is_sharp[v]) on_strip.push_back(v);
  }
  for (const Index v : on_strip) curvature[v] = 0;
  for (int sweep = 0; sweep < sweeps; ++sweep) {
    for (const Index v : on_strip) {
      double sum = 0;
      int count = 0;
      for (const Index w : band.rings[v]) {
        if (band.is_sharp[w] || (band.patch.on_border[w] && band.patch.ring[w] > 1)) continue;
        sum += curvature[w];
        ++count;
      }
      if (count > 0) curvature[v] = sum / count;
    }
  }
  return curvature;
}

// Solves min over u of Σ_i m_i |(S N u)_i / m_i − (h_i − H_i) n_i|². u moves the free vertices along their
// normals n, so that triangles keep their shape, and changes the mean curvature H to the wanted one, h. The
// rows belong to the vertices whose curvature changes; boundary vertices have none. The tangential components
// of the residual count, too, which limits folds.
void fair(Points& points, const Band& band, const Eigen::VectorXd& wanted, const Context& context) {
  const Shape shape(band, points, context);
  std::vector<Eigen::Triplet<double>> entries;
  Columns residual = Columns::Zero(3 * points.rows(), 1);
  for (Eigen::Index i = 0; i < points.rows(); ++i) {
    if (band.patch.on_border[i] || !(shape.areas[i] > 0)) continue;
    const double root = std::sqrt(shape.areas[i]);
    for (int axis = 0; axis < 3; ++axis) {
      const Eigen::Index row = 3 * i + axis;
      residual(row, 0) = root * (wanted[i] - shape.curvature[i]) * shape.normals(i, axis);
      for (SparseRows::InnerIterator entry(shape.stiffness, i); entry; ++entry) {
        if (band.column[entry.col()] < 0) continue;
        entries.emplace_back(static_cast<int>(row), band.column[entry.col()],
                             entry.value() / root * shape.normals(entry.col(), axis));
      }
    }
  }
  SparseRows rows(3 * points.rows(), band.unknowns);
  rows.setFromTriplets(entries.begin(), entries.end());
  const SparseRows columns = transpose(rows);
  auto lower = NormalMatrix(multiply(columns, rows, context).triangularView<Eigen::Lower>());
  // A vertex without a normal, or amid triangles without area, has no equation. This term keeps it in place.
  constexpr double attachment = 1e-9;
  const double scale = lower.diagonal().maxCoeff();
  NormalMatrix identity(lower.rows(),
                        lower.cols());  // such a vertex has no entry in `lower`, not even on its diagonal
  identity.setIdentity();
  lower += (scale > 0 ? attachment * scale : 1.0) * identity;
  const auto solver = make_solver();
  solver->analyse(lower, {}, context);
  solver->factorise(lower, context);
  const Eigen::MatrixXd moves = solver->solve(multiply(columns, residual, context), context);
  for (Index v = 0; v < static_cast<Index>(band.column.size()); ++v) {
    if (band.column[v] >= 0) points.row(v) += moves(band.column[v], 0) * shape.normals.row(v);
  }
}

// The free vertices next to the strips, which may move off their normals.
struct NearStrips {
  Flags all, but_sharp;  // with and without those on sharp edges, which are folds on the source

  explicit NearStrips(const Band& band) {
    constexpr int rings = 2;
    for (std::size_t v = 0; v < band.column.size(); ++v) {
      all.push_back(band.column[v] >= 0 && band.patch.ring[v] <= rings);
      but_sharp.push_back(all.back() && !band.is_sharp[v]);
    }
  }
};

}  // namespace

std::vector<Index> fair_seam(Mesh& mesh, const SeamLayout& layout, const SeamOptions& options,
                             const Context& context) {
  const Band band = make_band(mesh, layout, options);
  Points points = band.patch.points;
  for (Index v = 0; v < static_cast<Index>(points.rows()); ++v) {
    if (points.row(v).allFinite()) continue;
    throw Error(facts::merge::SeamVertexNotFinite{.vertex = band.patch.vertex[v]},
                Location::place("vertex " + std::to_string(band.patch.vertex[v]) + " of the joined mesh"));
  }
  if (options.fairing_method == FairingMethod::umbrella) {
    smooth_by_umbrella(points, band.rings, moving_vertices(band), options.fairings, context);
  } else if (band.unknowns > 0 && options.fairings > 0) {
    // Fairing is linear: it needs a surface without folds, and leaves thin triangles where it moves vertices
    // far.
    const NearStrips near(band);
    relax_seam(points, band.patch, band.triangles, near.but_sharp, context);
    for (int step = 0; step < options.fairings; ++step) {
      reduce_folds(points, band.patch, options.sharp_angle_deg, near.all, context);
      fair(points, band, continued_curvature(band, Shape(band, points, context).curvature), context);
      relax_seam(points, band.patch, band.triangles, near.but_sharp, context);
    }
    reduce_folds(points, band.patch, options.sharp_angle_deg, near.all, context);
  }
  std::vector<Index> moved;
  for (const Index v : moving_vertices(band)) {
    moved.push_back(band.patch.vertex[v]);
    mesh.positions.row(band.patch.vertex[v]) = points.row(v);
  }
  return moved;
}

}  // namespace meshgraft
