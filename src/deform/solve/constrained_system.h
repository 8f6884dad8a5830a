#pragma once

#include <array>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include <meshgraft/deform/deform_problem.h>
#include <meshgraft/linalg/linear_solver.h>

#include "core/stopwatch.h"
#include "deform/setup/patch.h"
#include "deform/setup/patch_operator.h"
#include "deform/setup/region_mask.h"
#include "deform/setup/solvability.h"
#include "fitted_field.h"
#include "linalg/sparse.h"
#include "operators/intrinsic_delaunay.h"

namespace meshgraft {

/// Maps F_v per vertex of the patch for the right-hand side, minus I: rows 3v … 3v+2 are (F_v − I)ᵀ. A field
/// without rows stands for I everywhere.
struct MapField {
  Columns maps;
  /// Whether the rows of E_R want M_i − M_j = F̃_i − F̃_j, with F̃ of `FittedField`. Otherwise only those of the
  /// stiffness know the field: x_i − x_j = ½(F_i + F_j)(p_i − p_j).
  bool smooth = true;
};

/// A mesh at rest with all that constrains it, except for the constraints' values.
struct ConstrainedMesh {
  std::shared_ptr<const RestMesh> rest;
  ConstraintMask mask;  ///< of all vertices of the mesh
  std::span<const Anchor> anchors;
  std::span<const Feature> features;
};

/// The least-squares problem of a deformation with constraints per vertex. The constructor assembles and
/// factorises it. It can then be solved for any values of the constraints.
///
/// All positions and maps are stored as differences from rest (x − p, M − I). An edit that moves nothing
/// therefore gives exactly zero, and small edits keep their relative precision.
///
/// Let y be the unknowns. The displacements of the nodes are E y + x_known. The maps are H (E
/// y + x_known) + F y + m_known, where F holds the maps that are shared columns themselves. The rows are
///
///   E_L rows:  A_L y = −(L x_known − Δ (H x_known + m_known)),   A_L = L E − Δ (H E + F)
///   E_R rows:  P G y = P (r − H x_known − m_known),              G = H E + F
///
/// The rows of stiffness and anchors follow those of E_L.
class ConstrainedSystem {
 public:
  /// Fills the counts of free and degenerate vertices, the seconds and the solver's facts in `summary`.
  /// `other` may be null. Otherwise it is a system on the same mesh with the same operator options, and its
  /// parts are shared where possible.
  ConstrainedSystem(const ConstrainedMesh& mesh, const DeformerOptions& options, DeformerSummary& summary,
                    const ConstrainedSystem* other, const Context& context);

  /// The known displacements of nodes and known maps minus I, as given by constraints.
  struct Known {
    Columns x, m;
  };
  Known known_values(std::span<const VertexConstraint> constraints) const;
  /// Returns known values that are all zero, with `columns` columns.
  Known no_values(Eigen::Index columns) const;

  /// How to solve for the unknowns.
  struct SolveSteps {
    int corrections = 0;  ///< number of corrections with the rectangular system's residual after the solve
    const Columns* guess = nullptr;  ///< unknowns of a similar problem, from which the solve starts
  };
  Columns solve(const Known& values, const MapField& field, const SolveSteps& steps,
                const Context& context) const;
  /// The parts that known values have in all solves with them. They do not depend on the field.
  struct KnownParts {
    Columns maps;  ///< their part of the local maps minus I (3·patch rows)
    Columns side;  ///< their part of the normal equations' right-hand side, with the anchors' targets
  };
  KnownParts known_parts(const Known& values, const Context& context) const;
  /// Memory of a solve. A series of solves shares it, because the first use of fresh pages takes time.
  struct SolveMemory {
    Columns at_maps, coupled, laplacian;
  };
  /// Solves for a smooth field, without corrections. An iterative solver starts from y unless it is empty, and
  /// ends at a relative error of max(`tolerance`, 1e-6).
  void solve(const KnownParts& known, const MapField& field, double tolerance, Columns& y, SolveMemory& memory,
             const Context& context) const;
  /// Solves for the unknowns that values and field cause, as if no anchor had a target. There may be any
  /// number of columns. `is_linear` must hold.
  Columns respond(const Known& values, const MapField& field, int corrections, const Context& context) const;
  SparseRows coupling(const Context& context) const;  ///< Returns PᵀP.

  // For many fields at once. Let φ be a number per vertex of the patch, F − I = φ e_axis eᵀ the field, and
  // all known values zero. Then field_rows[axis] φ is the right-hand side, which back-substitution replaces by
  // y. Sparse rows turn y into displacements of the free vertices and local maps.
  AlikeRows field_rows(const Context& context) const;
  void back_substitute(Columns& sides, const Context& context) const;
  SparseRows displacement_rows() const;
  const SparseRows& map_rows() const { return G_; }
  /// Returns whether solutions are linear in values, field and targets. They are if no feature is a
  /// similarity.
  bool is_linear() const { return similarities_.empty(); }
  /// Returns the number of rows of the right-hand sides, for estimates of the memory that one column takes.
  Eigen::Index row_count() const;

  /// Returns the map T of each feature in a solution, or I for a feature without columns in the system.
  std::vector<Eigen::Matrix3d> feature_maps(const Columns& y) const;
  /// Returns (T − I)ᵀ over tᵀ of a feature (4 rows, patch units), zero if it has no columns in the system.
  Columns feature_rows(std::size_t feature, const Columns& y) const;
  /// Returns the local maps of a solution minus I: rows 3v … 3v+2 are (M_v − I)ᵀ.
  Columns maps(const Columns& y, const Known& values, const Context& context) const;
  void maps(const Columns& y, const KnownParts& known, Columns& maps, const Context& context) const;
  /// Returns the displacements of all vertices of the patch in a solution (patch units), known ones included.
  Columns displacements(const Columns& y, const Known& values, const Context& context) const;

  /// The field on the right-hand side, and unknowns near the solution if there are any.
  struct Problem {
    MapField field;
    Columns guess;
  };
  /// Computes positions (n×3) for constraints that fit the mask. Fills the measures of `report` unless it is
  /// null. Fills `solved_maps`, unless it is null, with the solution's `maps`, or leaves it empty if nothing
  /// is free.
  void evaluate(std::span<const VertexConstraint> constraints, const Problem& problem, PointsRef out,
                EvaluationReport* report, Columns* solved_maps, const Context& context) const;
  /// Returns max ‖M_c(x) − W_c‖ over the given transforms at vertices next to a free vertex.
  double max_transform_deviation(std::span<const VertexConstraint> constraints, const Points& positions) const;
  /// Returns the number of vertices whose local map has a determinant that is not positive.
  Index count_inverted(const Columns& maps) const;
  OrderingGraph ordering_graph() const;
  NormalMatrix normal_matrix(const Context& context) const;
  double condition_estimate(const Context& context) const;

  const std::shared_ptr<const RestMesh>& mesh() const { return cut_->mesh; }
  const Points& rest() const { return cut_->mesh->points; }
  const Patch& patch() const { return cut_->patch; }
  // The faces and rings of the part of the patch around the unknowns. Rings of vertices without such a face
  // are empty.
  const Triangles& triangles() const { return part_ ? part_->triangles : patch().triangles; }
  bool is_part() const { return part_.has_value(); }
  const IndexLists& rings() const { return part_ ? part_->rings : operators_->rows().rings(); }
  /// Returns the mask of the patch's vertices.
  const ConstraintMask& mask() const { return mask_; }
  const std::vector<Feature>& features() const { return features_; }
  const std::vector<Index>& free_vertices() const { return free_; }
  const std::vector<Anchor>& anchors() const { return anchors_; }  ///< at vertices with an unknown position
  int residual_corrections() const { return residual_corrections_; }
  /// Returns the intrinsic Delaunay triangulation of `triangles`. The linear method does not need it.
  const IntrinsicEdges& intrinsic_edges() const { return *intrinsic_edges_; }
  /// Returns the bisection of the patch's rings, for other systems over the same rings.
  const std::shared_ptr<BisectionTree>& bisection() const { return bisection_; }
  /// Returns null if nothing is free. In a shared operator, `H` has rows for maps that are known here.
  const AffineOperator* operators() const { return operators_ ? &operators_->rows() : nullptr; }

 private:
  // Steps of the set-up.
  bool share(const ConstrainedSystem& other, const ConstrainedMesh& mesh, const Context& context);
  void restrict_to_patch(const ConstrainedMesh& mesh);
  void build_operator(const OperatorOptions& options, const Context& context);
  void assemble_and_factorise(const DeformerOptions& options, DeformerSummary& summary, Stopwatch& watch,
                              const ConstrainedSystem* other, const Context& context);
  std::vector<int> numbers_of(const ConstrainedSystem& other) const;
  bool change_factor_of(const ConstrainedSystem& other, SolverBackend backend, DeformerSummary& summary,
                        Stopwatch& watch, const Context& context);
  SparseRows choose_unknowns(const Context& context);
  void build_rows(const SparseRows& F, const DeformerOptions& options, const Context& context);
  double area_of(const Eigen::RowVector3<Index>& corners) const;
  double free_area() const;
  std::vector<double> stiffness_scales(const DeformerOptions& options) const;
  void list_edge_rows(const DeformerOptions& options);
  SparseRows stiffness_rows() const;
  SparseRows anchor_rows(Density density);
  void prepare_similarities(const Context& context);
  Eigen::Index shared_row(Eigen::Index s) const;
  void impose_similarities(Columns& y) const;
  void place_features(const Columns& y, PointsRef out) const;
  void weigh_anchors(const Context& context);
  void factorise(NormalMatrix normal, const OrderingGraph& graph, const DeformerOptions& options,
                 DeformerSummary& summary, Stopwatch& watch, const Context& context);
  Index count_degenerate() const;
  bool is_iterative() const;

  /// Right-hand sides or residuals of the rows. Those of E_R are P times their maps, which are a third as many
  /// numbers.
  struct Rows {
    Columns laplacian;  ///< of E_L, stiffness and anchors
    Columns maps;
  };
  Rows right_hand_side(const Known& values, const MapField& field, const Context& context) const;
  Columns known_maps(const Known& values, const Context& context) const;
  Columns laplacian_rows(const Known& values, const Columns& m, const MapField& field,
                         const Context& context) const;
  FittedField fitted_field() const { return {operators_->rows(), H(), mask_}; }
  Columns wanted_maps(const Columns& known, const MapField& field, const Context& context) const;
  void add_stretch(const Columns& maps, Eigen::Ref<Columns> edge_rows, const Context& context) const;
  AlikeRows minus_stretch() const;
  void add_targets(Rows& rows) const;
  Columns apply_transposed(const Rows& rows, const Context& context) const;
  Rows residual_rows(const Rows& rhs, const Columns& y, const Context& context) const;
  Columns solve(const Rows& rhs, const SolveSteps& steps, const Context& context) const;
  void place(const Columns& y, const Known& values, std::span<const VertexConstraint> constraints,
             PointsRef out, const Context& context) const;

  std::vector<Index> free_;  ///< global indices, ascending
  // These two may be shared with other systems.
  std::shared_ptr<const CutPatch> cut_;
  std::shared_ptr<const PatchOperator> operators_;
  std::optional<PatchPart> part_;         ///< set if a shared patch is larger than needed
  std::optional<SparseRows> fewer_maps_;  ///< H, if the operator's H has more maps
  const SparseRows& H() const { return fewer_maps_ ? *fewer_maps_ : operators_->rows().H(); }
  ConstraintMask mask_;     ///< of the patch's vertices
  double region_size_ = 1;  ///< √(area of the faces that touch a free vertex)
  /// An edge with a row of stiffness.
  struct EdgeRow {
    std::array<Index, 2> ends;
    double weight;
  };
  std::vector<EdgeRow> edge_rows_;
  std::shared_ptr<const IntrinsicEdges> intrinsic_edges_;  ///< of `triangles`; null where nothing needs it
  SparseRows stiffness_rows_;                              ///< rows × nodes
  std::vector<Anchor> anchors_;                            ///< at vertices with an unknown position
  std::vector<double> anchor_weights_;                     ///< per anchor: weight of its row
  SparseRows E_, A_L_, A_L_transposed_, G_, G_transposed_;
  std::unique_ptr<LinearSolver> solver_;
  std::shared_ptr<BisectionTree> bisection_ = std::make_shared<BisectionTree>();  ///< of the patch's rings
  int residual_corrections_ = 1;

  // Each feature has four shared columns. They are the last columns of y.
  std::vector<Feature> features_;
  std::vector<Index> feature_column_;     ///< first column per feature, or -1 if it has none
  Index shared_begin_ = 0;                ///< first shared column of all features
  std::vector<Index> similarities_;       ///< features that are similarities and have columns
  Eigen::MatrixXd similarity_response_;   ///< N⁻¹ e_s for their columns s, N = AᵀA; columns × 4 per feature
  Eigen::MatrixXd similarity_stiffness_;  ///< inverse of the response's rows s: the cost of moving s
};

}  // namespace meshgraft
