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
  /// Rest positions, (n + apexes)×3; under `ft05_noise` flat vertices are moved off their plane.
  Points positions;
  std::vector<Index> apex;            ///< n, the node of vertex i's apex, or -1
  std::vector<Index> moved;           ///< vertices that `ft05_noise` moved, ascending
  Flags flat;                         ///< n, 1 where the ring's P Pᵀ is (nearly) singular
  std::vector<Index> without_normal;  ///< fitted vertices whose faces define no normal, ascending
};

/// Choices per vertex for `make_stencil_nodes`.
struct StencilChoices {
  std::span<const std::uint8_t> fitted;   ///< n flags: vertex has a fitted map
  std::span<const std::uint8_t> movable;  ///< n flags: vertex may be moved off its plane
  /// Numbers (n) from which the noise's sides are drawn; empty = 0 … n-1.
  std::span<const Index> numbers;
};

/// Finds the flat rings among `fitted` vertices and treats them. Either all fitted vertices get apexes p_i +
/// h n_i (after Sumner & Popović 2004), or the flat vertices that are `movable` are moved along the normal
/// (FT05 equation 7).
StencilNodes make_stencil_nodes(const Points& points, const Points& normals, const IndexLists& rings,
                                const StencilChoices& choices, const OperatorOptions& options,
                                const Context& context = {});

/// Computes the local affine maps M_i = X_i P_iᵀ (P_i P_iᵀ)⁻¹ = Σ_{s∈S(i)} x_s h_{i,s}ᵀ as one matrix H,
/// 3n×nodes (FT05 equations 4 to 6). Row 3i+k holds the k-th component of h_{i,s}, so (H x)_{3i+k} = M_i e_k.
/// The stencil S(i) is the vertex, its ring and its apex, centred on the uniform mean of the ring. It is
/// widened by further rings where it spans too little. Rows of vertices that are not `fitted` are empty.
SparseRows local_map_operator(const StencilNodes& nodes, const IndexLists& rings,
                              std::span<const std::uint8_t> fitted, const Context& context = {});

/// Returns (X − W P) P⁺: the local map of a vertex that fits `edited` to `rest` best over its bare stencil,
/// in excess of `W`. Directions that the stencil does not span count as zero.
Eigen::Matrix3d local_map_deviation(Index vertex, const Points& rest, const Points& edited,
                                    const Eigen::Matrix3d& W, std::span<const Index> ring);

}  // namespace meshgraft
