#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <span>
#include <string_view>
#include <vector>

#include <meshgraft/core/context.h>
#include <meshgraft/linalg/linear_solver.h>
#include <meshgraft/mesh/mesh.h>
#include <meshgraft/mesh/topology.h>

namespace meshgraft {

struct IntrinsicEdges;

/// Ring weights w_ij (FT05 equation 2).
enum class WeightScheme { uniform, cotangent };

/// Weighting of the energy's rows: equal for all rows (`ft05`), or so that the same shape gives the same
/// result however finely it is triangulated (`aware`).
enum class Density { ft05, aware };

/// Treatments of a flat ring, where P Pᵀ is (nearly) singular.
enum class DegenerateTreatment {
  automatic,   ///< the one that measured better: apex
  ft05_noise,  ///< move the vertex off its plane, solve, move back (FT05 section 3.2)
  apex,        ///< an extra unknown above each vertex
};

/// Lengths by which `DegenerateTreatment::ft05_noise` moves flat vertices along their normals (FT05 equation
/// 7).
enum class NoiseLengths {
  equal,   ///< `noise_length_rel` at every vertex, to a random side
  random,  ///< 0.8 to 1.2 × `noise_length_rel`, to the side of the normal, as in FT05
};

struct OperatorOptions {
  WeightScheme weights = WeightScheme::uniform;
  Density density = Density::aware;
  DegenerateTreatment degenerate = DegenerateTreatment::automatic;
  double apex_height_rel = 0.5;    ///< × mean incident edge length
  double noise_length_rel = 0.25;  ///< × mean incident edge length
  NoiseLengths noise_lengths = NoiseLengths::equal;
  /// Ratio of smallest to largest eigenvalue of P Pᵀ below which a ring counts as flat.
  double flatness = 5e-5;
  std::uint64_t seed = 1;  ///< seed of the noise's sides and lengths
  /// Weight λ of the energy λ E_L + E_R; 1 in FT05 (docs/method.md explains the default).
  double laplacian_weight = 20;
  /// Rows of E_R as in FT05, (M_i − M_j)(p_i − p_j), are also made for the pairs of vertices that are opposite
  /// each other across an edge (its set SF). `has_integral_rows` tells where such rows are used.
  bool opposite_pairs = true;
  int laplacian_order = 1;  ///< 1 = FT05's umbrella; 2, 3: higher-order Laplacian in E_L (section 6)

  /// Returns the options of FT05 as written: `ft05_noise` with random lengths, no density, λ = 1. They never
  /// change.
  static OperatorOptions as_published();
};

/// Returns whether the rows of E_R are √w (M_i − M_j) over the intrinsic Delaunay triangulation. They are under
/// `Density::aware` with apexes. Otherwise they are FT05's.
bool has_integral_rows(const OperatorOptions& options);

/// Throws Error(input) with the id core.out_of_range, at the field, if a value is out of its range.
void validate(const OperatorOptions& options);

std::string_view to_string(WeightScheme value);
std::string_view to_string(Density value);
std::string_view to_string(DegenerateTreatment value);
std::string_view to_string(NoiseLengths value);

/// The parts of each vertex that are known before a solve, or shared with others. The vertices are those of a
/// mesh or of a patch of it. The mask has no values and no order; the solvers get both with the constraints.
struct ConstraintMask {
  Flags position;              ///< 1 where the position is known
  Flags transform;             ///< 1 where the local transform is known
  std::vector<Index> feature;  ///< index of the vertex's feature, or -1
  Flags anchored;              ///< 1 where a soft row draws the vertex to a target

  /// Makes a mask of no vertices.
  ConstraintMask() = default;
  /// Makes a mask of `count` vertices without features and anchors. All their positions and transforms are
  /// known, or none.
  ConstraintMask(Index count, bool known)
      : position(count, known), transform(count, known), feature(count, -1), anchored(count, 0) {}

  Index size() const { return static_cast<Index>(position.size()); }

  /// Returns whether the solve has to find the position or the transform.
  bool is_unknown(Index v) const { return !position[v] || !transform[v]; }
  /// Returns whether the local map is fitted to positions. Other maps are known or shared by a feature.
  bool is_fitted(Index v) const { return !transform[v] && feature[v] < 0; }
  /// Returns whether `DegenerateTreatment::ft05_noise` may move the vertex off its plane.
  bool is_movable(Index v) const { return !position[v] && is_fitted(v); }

  /// Returns the mask of the given vertices alone, in their order.
  ConstraintMask of(std::span<const Index> vertices) const {
    ConstraintMask some(static_cast<Index>(vertices.size()), false);
    for (std::size_t i = 0; i < vertices.size(); ++i) {
      some.position[i] = position[vertices[i]];
      some.transform[i] = transform[vertices[i]];
      some.feature[i] = feature[vertices[i]];
      some.anchored[i] = anchored[vertices[i]];
    }
    return some;
  }
};

/// A mesh or a patch of one, whose rows an `AffineOperator` holds.
struct OperatorMesh {
  const Points& points;        ///< n×3
  const Triangles& triangles;  ///< m×3
  /// For a patch: its vertices' indices in the mesh (n), from which the sides of `ft05_noise` are drawn.
  /// Empty stands for 0 … n−1.
  std::span<const Index> numbers{};
};

/// The nodes that local maps are fitted to: the mesh's vertices, then one apex for each vertex that has one.
struct StencilNodes {
  /// Rest positions, (n + apexes)×3; under `ft05_noise` flat vertices are moved off their plane.
  Points positions;
  std::vector<Index> apex;            ///< n, the node of vertex i's apex, or -1
  std::vector<Index> moved;           ///< vertices that `ft05_noise` moved, ascending
  Flags flat;                         ///< n, 1 where the ring's P Pᵀ is (nearly) singular
  std::vector<Index> without_normal;  ///< fitted vertices whose faces define no normal, ascending
};

/// The rows of E_L and E_R, as `AffineOperator` has them.
struct EnergyRows {
  SparseRows L, delta, P;
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
/// Under `Density::aware` E_L and E_R approximate integrals over the surface. Rows of E_L are scaled by ℓ̄/ℓ_i
/// (within 1e±3), where ℓ_i is the mean length of the edges at i, and ℓ̄ the mean of all ℓ_i. With apexes E_R is
/// 12 ℓ̄² Σ w_ij ‖M_i − M_j − (R_i − R_j)‖² over the edges of the intrinsic Delaunay triangulation, which
/// approximates 12 ℓ̄² ∫ ‖∂(M − R)‖². w_ij is the weight of cotangents × |p_i − p_j|² over the squared distance
/// between the places of the two maps (within 1/16 … 4). With `ft05_noise` the rows are FT05's, scaled by
/// 2 ℓ̄/(ℓ_i + ℓ_j). See docs/method.md.
class AffineOperator {
 public:
  /// Makes the rows of a mesh without constraints. `points` is n×3, `triangles` m×3. Throws Error(input) for
  /// options out of range.
  AffineOperator(const Points& points, const Triangles& triangles, const OperatorOptions& options = {},
                 const Context& context = {});
  /// Makes the rows of a mesh with constraints; `mask` has n vertices. Maps that it tells as known are not
  /// fitted; rows and pairs without an unknown are left out. Throws Error(input) for options out of range.
  AffineOperator(const OperatorMesh& mesh, const ConstraintMask& mask, const OperatorOptions& options = {},
                 const Context& context = {});

  const StencilNodes& nodes() const { return nodes_; }
  const SparseRows& L() const { return L_; }          ///< rows of E_L × nodes
  const SparseRows& delta() const { return delta_; }  ///< Δ, rows of E_L × 3n
  const SparseRows& H() const { return H_; }          ///< 3n × nodes
  const std::vector<std::array<Index, 2>>& pairs() const { return pairs_; }
  /// Returns the edges of the intrinsic Delaunay triangulation with their weights, or null without
  /// `has_integral_rows`.
  const std::shared_ptr<const IntrinsicEdges>& intrinsic_edges() const { return intrinsic_edges_; }
  const IndexLists& rings() const { return rings_; }
  const std::vector<double>& edge_lengths() const { return edge_lengths_; }  ///< ℓ_i, n
  double mean_edge_length() const { return mean_edge_length_; }              ///< ℓ̄

  /// Returns whether rows with this ratio ℓ̄/ℓ are scaled by exactly that ratio, and not by the bound of it.
  static bool is_scaled_by_density(double length_ratio);

  /// Makes P (rows of E_R × 3n). It is kept as a few numbers per pair, a tenth of its memory or a third.
  SparseRows P(const Context& context = {}) const;
  /// Computes PᵀP m for maps m (3n×k) without making P. `product` must not be m.
  void couple(const LinearSolver::Rows& m, LinearSolver::Rows& product, const Context& context = {}) const;
  /// Computes PᵀP, which couples the maps of pairs.
  SparseRows coupling(const Context& context = {}) const;

  /// Moves L and Δ out, with P. `P`, `couple`, `coupling` and `A` must not be called then. The rest stays.
  EnergyRows release_rows();

  /// Computes A = [L − Δ H; P H] over all nodes, without constraints.
  SparseRows A(const Context& context = {}) const;

 private:
  void build_laplacian_rows(const Points& points, const Triangles& triangles, const OperatorOptions& options,
                            const Flags& rows, const Context& context);
  void build_smoothness_rows(const Points& normals, const OperatorOptions& options, const Context& context);
  void build_integral_rows(const Points& places, const ConstraintMask& mask);
  void list_pairs_by_vertex();
  template <int columns>
  void couple_vertices(const LinearSolver::Rows& m, LinearSolver::Rows& product, const Context& context) const;

  IndexLists rings_;
  std::vector<double> edge_lengths_;
  double mean_edge_length_ = 0;
  StencilNodes nodes_;
  std::vector<std::array<Index, 2>> pairs_;
  // Pairs ascend. Their rows are dᵀ (M_i − M_j) for one or two vectors d, or the integral √w (M_i − M_j).
  std::vector<double> pair_values_;  ///< the vectors of all pairs, or √w per pair for integral rows
  IndexLists pairs_at_;              ///< per vertex: its pairs, by the other vertex
  std::shared_ptr<const IntrinsicEdges> intrinsic_edges_;
  SparseRows L_, delta_, H_;
};

}  // namespace meshgraft
