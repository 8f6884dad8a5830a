#pragma once

#include <span>
#include <vector>

#include <Eigen/Core>

#include <meshgraft/core/context.h>
#include <meshgraft/linalg/linear_solver.h>
#include <meshgraft/mesh/mesh.h>
#include <meshgraft/mesh/topology.h>
#include <meshgraft/operators/affine_operator.h>

namespace meshgraft {

/// The surface that stencils lie on: n×3 points, n×3 normals and the vertices' rings.
struct StencilSurface {
  const Points& points;
  const Points& normals;
  const IndexLists& rings;
  /// Numbers (n) from which the sides of `ft05_noise` are drawn; empty = 0 … n−1.
  std::span<const Index> numbers;
};

/// Finds the flat rings among the vertices with a fitted map, and treats them. Either all fitted vertices get
/// apexes p_i + h n_i (after Sumner & Popović 2004), or the flat vertices that are movable are moved along the
/// normal (FT05 equation 7).
StencilNodes make_stencil_nodes(const StencilSurface& surface, const ConstraintMask& mask,
                                const OperatorOptions& options, const Context& context = {});

/// Computes the local affine maps M_i = X_i P_iᵀ (P_i P_iᵀ)⁻¹ = Σ_{s∈S(i)} x_s h_{i,s}ᵀ as one matrix H,
/// 3n×nodes (FT05 equations 4 to 6). Row 3i+k holds the k-th component of h_{i,s}, so (H x)_{3i+k} = M_i e_k.
/// The stencil S(i) is the vertex, its ring and its apex, centred on the uniform mean of the ring. It is
/// widened by further rings where it spans too little. Rows of vertices without a fitted map are
/// empty.
SparseRows local_map_operator(const StencilNodes& nodes, const IndexLists& rings, const ConstraintMask& mask,
                              const Context& context = {});

/// Returns the places (n×3) of the local maps. A map that is fitted to a lopsided ring is, to second order, the
/// gradient at a place beside its vertex: p_i + ⅓ Σ_s (h_s·d_s) d_s over the ring, with d_s = p_s − p_i and the
/// coefficients h_s of a fit as in `local_map_operator`, with an apex that is one mean edge length high. It is
/// p_i in a ring with a centre of symmetry, and where the ring spans no plane. The place does not depend on
/// which maps are known.
Points map_places(const StencilSurface& surface, const Context& context = {});

/// One vertex with its ring and its constrained transform W.
struct ConstrainedStencil {
  Index vertex;
  std::span<const Index> ring;
  const Eigen::Matrix3d& W;
};

/// Returns (X − W P) P⁺: the local map of the vertex that fits `edited` to `rest` best over its bare stencil,
/// in excess of W. Directions that the stencil does not span count as zero.
Eigen::Matrix3d local_map_deviation(const ConstrainedStencil& stencil, const Points& rest,
                                    const Points& edited);

}  // namespace meshgraft
