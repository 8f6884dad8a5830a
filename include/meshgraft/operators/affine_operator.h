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

/// Unordered pairs of vertices that two faces with a common edge contain: the edges and the pairs opposite
/// across an edge (SF of FT05 equation 11). Ascending, without repeats; only pairs with a vertex in `active`
/// (flags per vertex); without `opposite` the edges alone.
std::vector<std::array<Index, 2>> smoothness_pairs(const Triangles& triangles,
                                                   const IndexLists& vertex_triangles, const IndexLists& rings,
                                                   std::span<const std::uint8_t> active, bool opposite = true,
                                                   const Context& context = {});

/// The rows of the method's energy over a mesh (or a patch of one), in the notation
///
///   λ E_L = ‖ L x − Δ m ‖²    (FT05 equation 9, times λ = `laplacian_weight`)
///     E_R = ‖ P (m − r) ‖²    (FT05 equation 11)
///
/// where x stacks the positions of all nodes (vertices, then apexes), m the local maps (m_{3i+k} = M_i e_k,
/// m = H x where the map is fitted) and r a field of rotations in the same order. Every row is the same for
/// the coordinates x, y and z. Substituting m gives the one matrix A = [L − Δ H; P H].
///
/// Rows under `Density::aware` are scaled by ℓ̄/ℓ (within 1e±3), so that E_L and E_R approximate integrals over
/// the surface: ℓ is ℓ_i, the mean length of the edges at i, in E_L and (ℓ_i + ℓ_j)/2 in E_R, and ℓ̄ the mean
/// of all ℓ_i. See docs/method.md.
class AffineOperator {
 public:
  /// Which rows and maps are wanted, as flags per vertex; empty = all.
  struct Extent {
    Flags fitted;                ///< M_i is fitted to positions (else row i of H is empty)
    Flags unknown;               ///< M_i is fitted or shared: its pairs have rows of E_R
    Flags movable;               ///< may be moved off its plane by `ft05_noise`
    Flags rows;                  ///< has a row of E_L
    std::vector<Index> numbers;  ///< of the vertices in a larger mesh; the noise's sides follow them
  };

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

  /// Whether rows at a place with ℓ̄/ℓ of this are scaled by just that, not by a bound.
  static bool is_scaled_by_density(double length_ratio);

  /// PᵀP, which couples the maps of pairs.
  SparseRows coupling(const Context& context = {}) const;

  /// A = [L − Δ H; P H] over all nodes, none of them constrained.
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
