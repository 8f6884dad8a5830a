#pragma once

#include <span>
#include <vector>

#include <meshgraft/core/context.h>
#include <meshgraft/linalg/linear_solver.h>
#include <meshgraft/mesh/mesh.h>
#include <meshgraft/mesh/topology.h>
#include <meshgraft/operators/affine_operator.h>

namespace meshgraft {

/// Computes the umbrella operator D of FT05 equation 2, n×n: (D x)_i = x_i − Σ_j w_ij x_j with Σ_j w_ij = 1,
/// so δ = D p. Cotangent weights are ½(cot α + cot β), with negative ones clamped to 0; where all vanish,
/// weights are uniform. Vertices without a ring have an empty row.
SparseRows umbrella_operator(const Points& points, const Triangles& triangles, const IndexLists& rings,
                             WeightScheme weights = WeightScheme::uniform, const Context& context = {});

/// Computes the symmetric positive semi-definite n×n matrix of the Dirichlet energy (Pinkall & Polthier
/// 1993). Its entries are −½(cot α + cot β) at (i, j), and their negative sums on the diagonal. Weights are
/// clamped to 0.001 … 4. A harmonic function then stays within its boundary values, every edge connects, and
/// needle-like triangles do not spoil the conditioning.
SparseRows dirichlet_matrix(const Points& points, const Triangles& triangles, const IndexLists& rings,
                            const Context& context = {});

/// Returns a third of the area of the faces at each vertex (n), squared model units.
std::vector<double> vertex_areas(const Points& points, const Triangles& triangles);

/// Returns the mean length of the edges at each vertex (n), model units; 0 where there are none.
std::vector<double> mean_edge_lengths(const Points& points, const IndexLists& rings);

/// Returns the mean of the entries that are not 0, or 1 if all are 0.
double mean_of_positive(std::span<const double> lengths);

}  // namespace meshgraft
