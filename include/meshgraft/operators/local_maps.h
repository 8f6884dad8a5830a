#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include <Eigen/Core>

#include <meshgraft/core/context.h>
#include <meshgraft/linalg/sparse.h>
#include <meshgraft/mesh/mesh.h>
#include <meshgraft/mesh/topology.h>
#include <meshgraft/operators/options.h>

namespace meshgraft {

/// The nodes that local maps are fitted to: the mesh's vertices, then one apex for each vertex that has one.
struct StencilNodes {
  Points positions;                   ///< rest positions, (n + apexes)×3; flat vertices moved off their plane
                                      ///< under `ft05_noise`
  std::vector<Index> apex;            ///< n, the node of vertex i's apex, or -1
  std::vector<Index> moved;           ///< vertices that `ft05_noise` moved, ascending
  Flags flat;                         ///< n, 1 where the ring's P Pᵀ is (nearly) singular
  std::vector<Index> without_normal;  ///< fitted vertices whose faces give no direction, ascending
};

/// What `make_stencil_nodes` may do with each vertex.
struct StencilChoices {
  std::span<const std::uint8_t> fitted;   ///< n flags: has a fitted map
  std::span<const std::uint8_t> movable;  ///< n flags: may be moved off its plane
  std::span<const Index> numbers;         ///< n, what the noise's side is drawn for; empty = 0 … n-1
};

/// Finds the flat rings among `fitted` vertices and treats them: apexes p_i + h n_i for all fitted vertices
/// (after Sumner & Popović 2004), or a move of the flat ones along the normal (FT05 equation 7) where
/// `movable`.
StencilNodes make_stencil_nodes(const Points& points, const Points& normals, const IndexLists& rings,
                                const StencilChoices& choices, const OperatorOptions& options,
                                const Context& context = {});

/// The local affine maps M_i = X_i P_iᵀ (P_i P_iᵀ)⁻¹ = Σ_{s∈S(i)} x_s h_{i,s}ᵀ as one matrix H, 3n×nodes:
/// row 3i+k holds the k-th component of h_{i,s}, so (H x)_{3i+k} = M_i e_k. The stencil S(i) is the vertex,
/// its ring and its apex, centred on the uniform mean of the ring; it is widened by further rings where it
/// spans too little. Rows of vertices that are not `fitted` are empty. (FT05 equations 4 to 6.)
SparseRows local_map_operator(const StencilNodes& nodes, const IndexLists& rings,
                              std::span<const std::uint8_t> fitted, const Context& context = {});

/// The local map of vertex i that fits `edited` to `rest` best over its bare stencil, in excess of `W`:
/// (X − W P) P⁺. Directions that the stencil does not span count as zero.
Eigen::Matrix3d local_map_deviation(Index vertex, const Points& rest, const Points& edited,
                                    const Eigen::Matrix3d& W, std::span<const Index> ring);

}  // namespace meshgraft
