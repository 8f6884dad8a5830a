#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include <meshgraft/core/context.h>
#include <meshgraft/deform/constraints.h>
#include <meshgraft/deform/handle.h>
#include <meshgraft/linalg/linear_solver.h>
#include <meshgraft/mesh/mesh.h>
#include <meshgraft/operators/affine_operator.h>
#include <meshgraft/operators/options.h>

namespace meshgraft {

class ConstrainedSystem;
class HandleBasis;
class ProxyDeformer;
class ReducedFrames;
class RotationField;
struct RestMesh;

/// What moves, what stays and what is held of a mesh.
struct Region {
  std::vector<Index> vertices{};  ///< the region of interest; with `whole` unused
  bool whole = false;             ///< the region is the whole mesh
  std::vector<Index> fixed{};     ///< vertices of the region that stay (position and transform I)
  std::vector<Handle> handles{};  ///< disjoint from each other and from `fixed`
  std::vector<Anchor> anchors{};
  std::vector<Feature> features{};
};

/// How rotations spread from the constraints (docs/methods.md). The matrix is the same but for `stiffness`;
/// what differs is the field of maps F_i on the right-hand side of E_R, ‖(M_i − M_j) d − (F_i − F_j) d‖².
enum class DeformMethod {
  ft05,            ///< F = I: maps are blended linearly (Fu & Tai 2005)
  rotation_aware,  ///< F blends the logarithms of the constraints' rotations and stretches
  corotational,    ///< starts there, then F follows the rotations of the surface itself
};

std::string_view to_string(DeformMethod value);

struct DeformerOptions {
  // The method.
  DeformMethod method = DeformMethod::corotational;
  /// μ ≥ 0 of extra rows on edges that keep lengths (not of `ft05`): 0 bends most evenly, more is more rigid.
  /// Under `Density::aware` relative to bending over the region's size, else as plain rows of weight μ.
  double stiffness = 60;
  int iterations = 20;  ///< most co-rotational steps
  /// Length over which the co-rotational field is kept smooth, × the width of the surface between constraints.
  double smoothing_length_rel = 0.09;
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
  bool reused = false;  ///< patch, operator and cuts are those of another set-up (`Deformer::with_region`)
  double assemble_seconds = 0;
  double analyse_seconds = 0;
  double factorise_seconds = 0;  ///< with the scalar systems that spread rotations
  SolverStatistics solver{};
};

/// What one evaluation can tell about itself.
struct EvaluationReport {
  double residual = 0;                 ///< ‖Aᵀ(b − A x)‖ / ‖Aᵀ b‖, 0 for a zero right-hand side
  double max_transform_deviation = 0;  ///< max ‖M_c(x) − W_c‖_F over constrained transforms
  int iterations = 0;                  ///< co-rotational steps that were made
  int solver_iterations = 0;           ///< of the backend `iterative`, in the last solve
  double last_rotation_change = 0;     ///< of the field that the last of them asked for, RMS, radians
  Index inverted_maps = 0;             ///< free vertices whose local map has a determinant of 0 or less
  /// A constraint reflects or flattens: there is no logarithm, and transforms were blended linearly.
  bool fell_back_to_linear = false;
};

/// Deforms a region of a mesh by its handles (Fu & Tai 2005, sections 3 and 4). The constructor validates,
/// assembles and factorises; evaluation is back-substitutions: two, and one per co-rotational step.
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

  /// A Deformer of the same mesh and options for another region: the same as one that is made from nothing, to
  /// 1e-10 of the box. Where what is unknown then is unknown here too (another handle, more that is fixed; a
  /// handle that an earlier call added goes again), and no less than about half of it, the two share patch,
  /// operator and the cuts that order the elimination, and only the matrix is assembled and factorised anew;
  /// else nothing is shared. `summary().reused` tells. Neither depends on the other later. Throws what the
  /// constructor throws.
  Deformer with_region(const Region& region, const Context& context = {}) const;

  Deformer(Deformer&&) noexcept;
  Deformer& operator=(Deformer&&) noexcept;
  ~Deformer();

  /// New positions, n×3, for one pose per handle, by the method of the options. Vertices outside the region
  /// keep their bits; handle vertices are exactly at `pose · p`. Measures what it did where there is a
  /// `report`.
  Points evaluate(std::span<const HandlePose> poses, const Context& context = {},
                  EvaluationReport* report = nullptr) const;
  /// The same into the caller's memory (n×3; throws Error(usage) for another shape).
  void evaluate(std::span<const HandlePose> poses, Points& positions_out, const Context& context = {},
                EvaluationReport* report = nullptr) const;

  /// New positions for constraints per vertex, in the order they were given to `with_constraints`.
  Points evaluate(std::span<const VertexConstraint> constraints, const Context& context = {},
                  EvaluationReport* report = nullptr) const;

  /// The same with the caller's field F (n maps, one per vertex of the mesh) in the place of the method's:
  /// ‖(M_i − M_j) d − (F_i − F_j) d‖², one linear solve.
  Points evaluate_with_field(std::span<const VertexConstraint> constraints,
                             std::span<const Eigen::Matrix3d> field, const Context& context = {},
                             EvaluationReport* report = nullptr) const;

  /// The constraints that handle poses amount to.
  std::vector<VertexConstraint> constraints(std::span<const HandlePose> poses) const;

  /// Lower bound of the condition number of AᵀA; costs a few solves.
  double condition_estimate(const Context& context = {}) const;

  /// The operator over the patch that the solve is made on (scaled to unit size; `patch_vertices` names its
  /// vertices): D, h, H, Δ, P, A. Where it is shared, it has rows of maps that are known here too. For study.
  const AffineOperator& affine_operator() const;
  std::span<const Index> patch_vertices() const;
  /// AᵀA over the unknowns, lower triangle; assembled anew at each call.
  NormalMatrix normal_matrix(const Context& context = {}) const;

  const DeformerSummary& summary() const;

  /// Vertices whose position is solved for, ascending.
  std::span<const Index> free_vertices() const;

 private:
  // What is built on a set-up: its problem, its handles (none of constraints per vertex), its options.
  friend HandleBasis;
  friend ProxyDeformer;
  friend ReducedFrames;
  const ConstrainedSystem& system() const;
  std::span<const Handle> handles() const;
  const DeformerOptions& options() const;
  bool is_of_handles() const;
  const RotationField* rotation_field() const;

  Deformer();
  static Deformer of_region(std::shared_ptr<const RestMesh> mesh, const Region& region,
                            const DeformerOptions& options, const Deformer* other, const Context& context);
  /// `evaluate`, and the local map of each vertex of the mesh less I; zero where nothing tells it.
  Points evaluate_with_maps(std::span<const VertexConstraint> constraints,
                            std::vector<Eigen::Matrix3d>& map_changes, const Context& context,
                            EvaluationReport* report) const;
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace meshgraft
