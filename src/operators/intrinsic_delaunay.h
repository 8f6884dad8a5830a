#pragma once

#include <array>
#include <vector>

#include <meshgraft/core/context.h>
#include <meshgraft/mesh/mesh.h>

#include "linalg/sparse.h"

namespace meshgraft {

/// An edge with a weight in the Dirichlet energy Σ w (f_i − f_j)².
struct CotangentEdge {
  std::array<Index, 2> ends{-1, -1};  ///< smaller and larger vertex
  double weight = 0;                  ///< ½(cot α + cot β), within 0.001 … 16
};

/// The edges of a surface's intrinsic Delaunay triangulation, ascending in their ends, with the weights of
/// cotangents.
struct IntrinsicEdges {
  std::vector<CotangentEdge> edges;
  bool differ = false;  ///< whether edges were flipped or lengths changed
};

/// Returns the intrinsic Delaunay triangulation: edges are flipped, as if the two triangles were unfolded into
/// a plane, until opposite angles sum to at most 180°. Σ w (f_i − f_j)² over the edges is then ∫ ‖∂f‖² for a
/// linear function f without negative weights, whatever the shape of the triangles (Bobenko and Springborn
/// 2007). Lengths are first enlarged by so much that the triangle inequality holds with a margin (Sharp and
/// Crane 2020). Edges that do not join two consistently oriented faces are not flipped.
IntrinsicEdges intrinsic_delaunay_edges(const Points& points, const Triangles& triangles,
                                        const Context& context = {});

/// Computes the symmetric positive semi-definite n×n matrix of the Dirichlet energy Σ w (f_i − f_j)².
SparseRows dirichlet_matrix(Index vertex_count, const IntrinsicEdges& surface);

}  // namespace meshgraft
