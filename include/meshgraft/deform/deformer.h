#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include <meshgraft/core/context.h>
#include <meshgraft/deform/constraints.h>
#include <meshgraft/deform/handle.h>
#include <meshgraft/linalg/linear_solver.h>
#include <meshgraft/mesh/mesh.h>
#include <meshgraft/operators/affine_operator.h>
#include <meshgraft/operators/options.h>

namespace meshgraft {

/// What moves, what stays and what is held of a mesh.
struct Region {
  std::vector<Index> vertices{};  ///< the region of interest; with `whole` unused
  bool whole = false;             ///< the region is the whole mesh
  std::vector<Index> fixed{};     ///< vertices of the region that stay (position and transform I)
  std::vector<Handle> handles{};  ///< disjoint from each other and from `fixed`
  std::vector<Anchor> anchors{};
  std::vector<Feature> features{};
};

struct DeformerOptions {
  // The operator.
  OperatorOptions operators{};
  // The solve.
  SolverBackend backend = SolverBackend::automatic;
  int residual_corrections = 1;  ///< corrections with the residual of the rectangular system per solve
};

/// Seconds per stage and facts of the set-up.
struct DeformerSummary {
  Index free_vertices = 0;   ///< positions that are solved for
  Index fixed_vertices = 0;  ///< of the region
  Index handle_vertices = 0;
  Index degenerate_vertices = 0;  ///< free vertices with a flat or near-flat neighbourhood
  double assemble_seconds = 0;
  double analyse_seconds = 0;
  double factorise_seconds = 0;
  SolverStatistics solver{};
};

/// What one evaluation can tell about itself.
struct EvaluationReport {
  double residual = 0;                 ///< ‖Aᵀ(b − A x)‖ / ‖Aᵀ b‖, 0 for a zero right-hand side
  double max_transform_deviation = 0;  ///< max ‖M_c(x) − W_c‖_F over constrained transforms
};

/// Deforms a region of a mesh by its handles (Fu & Tai 2005, sections 3 and 4). The constructor validates,
/// assembles and factorises; evaluation is two back-substitutions.
class Deformer {
 public:
  /// `rest` n×3, `triangles` m×3. Throws Error(input) for bad indices, an empty or overlapping handle, a
  /// non-finite coordinate within reach; Error(unsolvable) where a free component is not held well enough,
  /// naming the component and what to add.
  Deformer(const Points& rest, const Triangles& triangles, const Region& region,
           const DeformerOptions& options = {}, const Context& context = {});

  /// The same for constraints per vertex. Vertices outside `region` (all vertices if empty) are fixed with
  /// W = I. The values in `constraints` are the first evaluation's; later ones may differ, what is given not.
  static Deformer with_constraints(const Points& rest, const Triangles& triangles,
                                   std::span<const Index> region, std::span<const VertexConstraint> constraints,
                                   std::span<const Anchor> anchors, std::span<const Feature> features,
                                   const DeformerOptions& options = {}, const Context& context = {});

  Deformer(Deformer&&) noexcept;
  Deformer& operator=(Deformer&&) noexcept;
  ~Deformer();

  /// New positions, n×3, for one pose per handle. Vertices outside the region keep their bits; handle
  /// vertices are exactly at `pose · p`.
  Points evaluate(std::span<const HandlePose> poses, const Context& context = {}) const;
  /// The same into the caller's memory (n×3; throws Error(usage) for another shape).
  void evaluate(std::span<const HandlePose> poses, Points& positions_out, const Context& context = {}) const;

  /// New positions for constraints per vertex, in the order they were given to `with_constraints`. `field` is
  /// the per-vertex rotation field R (n matrices, or none for R = I).
  Points evaluate(std::span<const VertexConstraint> constraints, std::span<const Eigen::Matrix3d> field,
                  const Context& context = {}) const;

  /// The constraints that handle poses amount to.
  std::vector<VertexConstraint> constraints(std::span<const HandlePose> poses) const;

  /// Measures what `evaluate` makes of `constraints`; costs one evaluation.
  EvaluationReport inspect(std::span<const VertexConstraint> constraints,
                           std::span<const Eigen::Matrix3d> field = {}, const Context& context = {}) const;

  /// Lower bound of the condition number of AᵀA; costs a few solves.
  double condition_estimate(const Context& context = {}) const;

  /// The operator over the patch that the solve is made on (scaled to unit size; `patch_vertices` names its
  /// vertices): D, h, H, Δ, P, A. For study.
  const AffineOperator& affine_operator() const;
  std::span<const Index> patch_vertices() const;
  /// AᵀA over the unknowns, lower triangle; assembled anew at each call.
  NormalMatrix normal_matrix(const Context& context = {}) const;

  const DeformerSummary& summary() const;

  /// Vertices whose position is solved for, ascending.
  std::span<const Index> free_vertices() const;

 private:
  Deformer();
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace meshgraft
