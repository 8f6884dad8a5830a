#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include <meshgraft/core/context.h>
#include <meshgraft/linalg/sparse.h>
#include <meshgraft/mesh/mesh.h>
#include <meshgraft/mesh/topology.h>
#include <meshgraft/operators/local_maps.h>
#include <meshgraft/operators/options.h>

namespace meshgraft {

/// Returns the unordered pairs of vertices that two faces with a common edge contain (SF of FT05 equation
/// 11). These are the edges and the pairs opposite across an edge; without `opposite` the edges alone. The
/// pairs are ascending, without repeats, and have at least one vertex in `active` (flags per vertex).
std::vector<std::array<Index, 2>> smoothness_pairs(const Triangles& triangles,
                                                   const IndexLists& vertex_triangles, const IndexLists& rings,
                                                   std::span<const std::uint8_t> active, bool opposite = true,
                                                   const Context& context = {});

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
  /// Rows and maps to build, as flags per vertex; empty = all.
  struct Extent {
    Flags fitted;                ///< M_i is fitted to positions (else row i of H is empty)
    Flags unknown;               ///< M_i is fitted or shared by a feature: pairs with i have rows of E_R
    Flags movable;               ///< vertex may be moved off its plane by `ft05_noise`
    Flags rows;                  ///< vertex has a row of E_L
    std::vector<Index> numbers;  ///< vertex indices in a larger mesh, which determine the noise's sides
  };

  /// `points` n×3, `triangles` m×3.
  AffineOperator(const Points& points, const Triangles& triangles, const OperatorOptions& options = {},
                 const Extent& extent = {}, const Context& context = {});

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
