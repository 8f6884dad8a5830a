#pragma once

#include <span>
#include <vector>

#include <meshgraft/core/context.h>
#include <meshgraft/linalg/sparse.h>
#include <meshgraft/mesh/mesh.h>
#include <meshgraft/mesh/topology.h>
#include <meshgraft/operators/options.h>

namespace meshgraft {

/// The umbrella operator D of FT05 equation 2, n×n: (D x)_i = x_i − Σ_j w_ij x_j with Σ_j w_ij = 1, so
/// δ = D p. Cotangent weights are ½(cot α + cot β), negative ones clamped to 0, uniform where all vanish.
/// Vertices without a ring have an empty row.
SparseRows umbrella_operator(const Points& points, const Triangles& triangles, const IndexLists& rings,
                             WeightScheme weights, const Context& context = {});

/// Symmetric positive semi-definite n×n matrix of the Dirichlet energy: −½(cot α + cot β) at (i, j), sums on
/// the diagonal (Pinkall & Polthier 1993). Weights are clamped to 0.001 … 4: a harmonic function then stays
/// within its boundary values, every edge connects, and triangles like needles do not spoil the conditioning.
SparseRows dirichlet_matrix(const Points& points, const Triangles& triangles, const IndexLists& rings,
                            const Context& context = {});

/// A third of the area of the faces at each vertex (n), squared model units.
std::vector<double> vertex_areas(const Points& points, const Triangles& triangles);

/// Mean length of the edges at each vertex (n), model units; 0 where there are none.
std::vector<double> mean_edge_lengths(const Points& points, const IndexLists& rings);

/// Mean of those that are not 0; 1 where all are.
double mean_of_positive(std::span<const double> lengths);

}  // namespace meshgraft
