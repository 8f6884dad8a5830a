#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include <meshgraft/core/context.h>
#include <meshgraft/linalg/sparse.h>
#include <meshgraft/mesh/mesh.h>
#include <meshgraft/mesh/topology.h>
#include <meshgraft/operators/constraint_mask.h>
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

/// The rows of the method's energy over a mesh (or a patch of one), in the notation
///
///   λ E_L = ‖ L x − Δ m ‖²    (FT05 equation 9, times λ = `laplacian_weight`)
///     E_R = ‖ P (m − r) ‖²    (FT05 equation 11)
///
/// Here x stacks the positions of all nodes (vertices, then apexes). The vector m stacks the local maps:
/// m_{3i+k} = M_i e_k, and m = H x where the map is fitted. The vector r is a field of rotations in the same
/// order. Every row is the same for the coordinates x, y and z. Substituting m gives the one matrix
/// A = [L − Δ H; P H].
///
/// Under `Density::aware` rows are scaled by ℓ̄/ℓ (within 1e±3), so that E_L and E_R approximate integrals
/// over the surface. In E_L ℓ is ℓ_i, the mean length of the edges at i; in E_R it is (ℓ_i + ℓ_j)/2. ℓ̄ is
/// the mean of all ℓ_i. See docs/method.md.
class AffineOperator {
 public:
  /// `points` is n×3, `triangles` m×3. `mask` has n vertices, or none for a mesh without constraints. Maps that
  /// it tells as known are not fitted; rows and pairs without an unknown are left out. If the mesh is a patch
  /// of a larger one, `numbers` (n) are its vertices' indices there, from which the sides of `ft05_noise` are
  /// drawn. Otherwise it may be empty. Throws Error(input) for options out of range.
  AffineOperator(const Points& points, const Triangles& triangles, const OperatorOptions& options = {},
                 const ConstraintMask& mask = {}, const Context& context = {},
                 std::span<const Index> numbers = {});

  const StencilNodes& nodes() const { return nodes_; }
  const SparseRows& L() const { return L_; }          ///< rows of E_L × nodes
  const SparseRows& delta() const { return delta_; }  ///< Δ, rows of E_L × 3n
  const SparseRows& H() const { return H_; }          ///< 3n × nodes
  const SparseRows& P() const { return P_; }          ///< rows of E_R × 3n
  const std::vector<std::array<Index, 2>>& pairs() const { return pairs_; }
  const IndexLists& rings() const { return rings_; }
  const std::vector<double>& edge_lengths() const { return edge_lengths_; }  ///< ℓ_i, n
  double mean_edge_length() const { return mean_edge_length_; }              ///< ℓ̄

  /// Returns whether rows with this ratio ℓ̄/ℓ are scaled by exactly that ratio, and not by the bound of it.
  static bool is_scaled_by_density(double length_ratio);

  /// Computes PᵀP, which couples the maps of pairs.
  SparseRows coupling(const Context& context = {}) const;

  /// Computes A = [L − Δ H; P H] over all nodes, without constraints.
  SparseRows A(const Context& context = {}) const;

 private:
  void build_laplacian_rows(const Points& points, const Triangles& triangles, const OperatorOptions& options,
                            const Flags& rows, const Context& context);
  void build_smoothness_rows(const Points& normals, const OperatorOptions& options, const Context& context);

  IndexLists rings_;
  std::vector<double> edge_lengths_;
  double mean_edge_length_ = 0;
  StencilNodes nodes_;
  std::vector<std::array<Index, 2>> pairs_;
  SparseRows L_, delta_, H_, P_;
};

}  // namespace meshgraft
