#pragma once

#include <memory>
#include <span>
#include <vector>

#include <meshgraft/core/context.h>
#include <meshgraft/deform/deform_problem.h>
#include <meshgraft/mesh/mesh.h>
#include <meshgraft/operators/affine_operator.h>

namespace meshgraft {

/// Deforms a region of a mesh by its handles (Fu & Tai 2005, sections 3 and 4). The constructor validates,
/// assembles and factorises. An evaluation takes two back-substitutions, that of `corotational` one per
/// iteration and mostly one more. That of `shell` factorises in each of its steps besides.
class Deformer {
 public:
  /// Throws Error(input) for bad indices, an empty or overlapping handle, a vertex that is constrained twice,
  /// or a non-finite coordinate that the edit reaches (deform.vertex_not_finite). Throws Error(usage) for both
  /// handles and constraints per vertex. Throws Error(unsolvable) where the constraints do not determine a free
  /// connected component, naming the component and what to add (deform.component_not_held,
  /// deform.component_held_by_positions). Throws Error(memory) with the id deform.solve_exceeds_memory for a
  /// region too large to solve exactly.
  explicit Deformer(DeformProblem problem, const DeformerOptions& options = {}, const Context& context = {});
  /// Does the same for a region with handles. `rest` is n×3, `triangles` m×3.
  Deformer(const Points& rest, const Triangles& triangles, const Region& region,
           const DeformerOptions& options = {}, const Context& context = {});

  /// Makes a Deformer of the same mesh and options for another region. The result equals that of a newly
  /// constructed Deformer to 1e-10 of the bounding box. Neither Deformer depends on the other afterwards.
  ///
  /// The two share the patch, the operator and the bisection tree of the elimination order where possible.
  /// With `ft05`, without anchors, they share most of the factor, too, if a little less is unknown. `reused` in
  /// the summary says whether anything is shared. All unknowns of the new Deformer must be unknowns here, and
  /// at least about half of these. Examples are one more handle, more fixed vertices, or removal of a handle
  /// that an earlier call added.
  ///
  /// Throws what the constructor throws.
  Deformer with_region(const Region& region, const Context& context = {}) const;

  Deformer(Deformer&&) noexcept;
  Deformer& operator=(Deformer&&) noexcept;
  ~Deformer();

  /// Returns new positions, n×3, for one pose per handle, by the method of the options. Vertices outside the
  /// region keep their coordinates bit for bit; handle vertices are exactly at `pose · p`. Fills `report` if
  /// it is not null. Throws Error(usage) for another number of poses.
  Points evaluate(std::span<const HandlePose> poses, const Context& context = {},
                  EvaluationReport* report = nullptr) const;
  /// Writes the same positions to `positions_out` (n×3), whose content is unspecified after an error. Throws
  /// Error(usage) for another shape.
  void evaluate(std::span<const HandlePose> poses, PointsRef positions_out, const Context& context = {},
                EvaluationReport* report = nullptr) const;

  /// Returns new positions, n×3, for constraints per vertex, in the order of the problem. Those of handles
  /// come in the order of the handles and of their vertices.
  Points evaluate(std::span<const VertexConstraint> constraints, const Context& context = {},
                  EvaluationReport* report = nullptr) const;
  /// Writes the same positions to `positions_out` (n×3). Throws Error(usage) for another shape.
  void evaluate(std::span<const VertexConstraint> constraints, PointsRef positions_out,
                const Context& context = {}, EvaluationReport* report = nullptr) const;

  /// Returns new positions, n×3, with the caller's field F in place of the method's, by one linear solve of
  /// ‖(M_i − M_j) d − (F_i − F_j) d‖².
  /// `field` has n maps, one per vertex of the mesh. Throws Error(usage) for another number of maps.
  Points evaluate_with_field(std::span<const VertexConstraint> constraints,
                             std::span<const Eigen::Matrix3d> field, const Context& context = {},
                             EvaluationReport* report = nullptr) const;

  /// Returns the constraints per vertex that handle poses stand for. Throws Error(usage) for another number
  /// of poses.
  std::vector<VertexConstraint> constraints(std::span<const HandlePose> poses) const;

  /// Returns a lower bound of the condition number ‖AᵀA‖₁ ‖(AᵀA)⁻¹‖₁, by AᵀA and a few solves.
  double condition_estimate(const Context& context = {}) const;

  /// Returns the operator over the patch on which the system is solved (scaled to unit size): L, Δ, H, P, A.
  /// `patch_vertices` lists the patch's vertices. A shared operator also has rows for maps that are known
  /// in this Deformer. For study.
  const AffineOperator& affine_operator() const;
  std::span<const Index> patch_vertices() const;
  /// Returns the lower triangle of AᵀA over the unknowns. It is assembled anew at each call.
  NormalMatrix normal_matrix(const Context& context = {}) const;

  const DeformerSummary& summary() const;

  /// Returns the vertices whose position is solved for, ascending.
  std::span<const Index> free_vertices() const;

  /// The set-up, for classes of the library; its type is private to the library.
  struct Impl;
  const Impl& impl() const { return *impl_; }

 private:
  explicit Deformer(std::unique_ptr<Impl> impl);
  std::unique_ptr<Impl> impl_;
};

}  // namespace meshgraft
