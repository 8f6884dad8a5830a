#pragma once

#include <array>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include <meshgraft/deform/deformer.h>
#include <meshgraft/linalg/sparse.h>

#include "patch.h"
#include "patch_operator.h"
#include "region_states.h"
#include "solvability.h"

namespace meshgraft {

/// Maps F_v per vertex of the patch on the right-hand side, less I: rows 3v … 3v+2 are (F_v − I)ᵀ. A field
/// without rows stands for I everywhere.
struct MapField {
  Columns smoothness;  ///< of E_R: (M_i − M_j) d = (F_i − F_j) d
  Columns stretch;     ///< of the stiffness: x_i − x_j = ½(F_i + F_j)(p_i − p_j)
};

/// The least-squares problem of a deformation with constraints per vertex: assembled and factorised by the
/// constructor, solved for any values of the constraints.
///
/// All positions and maps are kept as differences from rest (x − p, M − I): then an edit that moves nothing
/// gives exactly nothing, and small edits keep their own precision.
///
/// With y the unknowns, the nodes' displacements are E y + x_known and the maps H (E y + x_known) + F y +
/// m_known; F holds the maps that are shared columns themselves. So
///
///   E_L rows:  A_L y = −(L x_known − Δ (H x_known + m_known)),   A_L = L E − Δ (H E + F)
///   E_R rows:  P G y = P (r − H x_known − m_known),              G = H E + F
///
/// Rows of stiffness and anchors stand below those of E_L.
class ConstrainedSystem {
 public:
  /// Fills the free and degenerate counts, the seconds and the solver's facts of `summary`. Shares what it can
  /// with `other`, if there is one: a system on the same mesh with the same options of the operator.
  ConstrainedSystem(std::shared_ptr<const RestMesh> mesh, const VertexStates& states,
                    std::span<const Anchor> anchors, std::span<const Feature> features,
                    const DeformerOptions& options, DeformerSummary& summary, const ConstrainedSystem* other,
                    const Context& context);

  /// Known displacements of nodes and known maps less I, from constraints.
  struct Known {
    Columns x, m;
  };
  Known known_values(std::span<const VertexConstraint> constraints) const;
  /// Nothing known moves; room for `columns` columns.
  Known no_values(Eigen::Index columns) const;

  /// How the unknowns are solved for.
  struct SolveSteps {
    int corrections = 0;  ///< with the residual of the rectangular system, after the back-substitution
    const Columns* guess = nullptr;  ///< unknowns of a similar problem; an iterative solver starts there
  };
  Columns solve(const Known& values, const MapField& field, const SolveSteps& steps,
                const Context& context) const;
  /// How the unknowns follow from values and field alone, as if no anchor had a target. Any number of columns;
  /// `is_linear` must hold.
  Columns respond(const Known& values, const MapField& field, int corrections, const Context& context) const;
  /// The same by one back-substitution, for many columns: given PᵀP, the rows of E_R, four times as many as
  /// those of the maps, are never written out.
  Columns respond(const Known& values, const MapField& field, const SparseRows& coupling,
                  const Context& context) const;
  SparseRows coupling(const Context& context) const;  ///< PᵀP

  // For many fields at once: with φ a number per vertex of the patch and the field F − I = φ e_axis eᵀ, all
  // known values zero, the right-hand side is field_rows(axis) φ; y solves for it, and gives the displacements
  // of the free vertices and the local maps by sparse rows.
  SparseRows field_rows(int axis, const SparseRows& coupling, const Context& context) const;
  Columns back_substitute(const Columns& rhs, const Context& context) const;
  SparseRows displacement_rows() const;
  const SparseRows& map_rows() const { return G_; }
  /// Without features that are similarities, whatever is solved for is linear in values, field and targets.
  bool is_linear() const { return similarities_.empty(); }
  /// The rows of a full set of right-hand sides: what one of their columns takes of memory.
  Eigen::Index row_count() const;

  /// The map T of each feature in a solution; I for those that nothing reaches.
  std::vector<Eigen::Matrix3d> feature_maps(const Columns& y) const;
  /// (T − I)ᵀ and below it tᵀ of a feature's map (4 rows, patch units); zero for one that nothing reaches.
  Columns feature_rows(std::size_t feature, const Columns& y) const;
  /// The local maps of a solution less I: rows 3v … 3v+2 are (M_v − I)ᵀ.
  Columns maps(const Columns& y, const Known& values, const Context& context) const;
  /// The displacements of the patch's vertices in a solution (patch units); those of known positions too.
  Columns displacements(const Columns& y, const Known& values, const Context& context) const;

  /// The field on the right-hand side, and unknowns near the solution if there are any at hand.
  struct Problem {
    MapField field;
    Columns guess;
  };
  /// Positions (n×3) for constraints that fit `states`; fills `report`'s measures if there is one, and with the
  /// solution's `maps` `solved_maps`, empty where nothing is free.
  void evaluate(std::span<const VertexConstraint> constraints, const Problem& problem, Points& out,
                EvaluationReport* report, Columns* solved_maps, const Context& context) const;
  OrderingGraph ordering_graph() const;
  NormalMatrix normal_matrix(const Context& context) const;
  double condition_estimate(const Context& context) const;

  const std::shared_ptr<const RestMesh>& mesh() const { return cut_->mesh; }
  const Points& rest() const { return cut_->mesh->points; }
  const Patch& patch() const { return cut_->patch; }
  // The part of the patch around what is unknown: the faces, and the rings, empty for vertices that no face is
  // at.
  const Triangles& triangles() const { return part_ ? part_->triangles : patch().triangles; }
  const IndexLists& rings() const { return part_ ? part_->rings : operators_->rows().rings(); }
  const KnownParts& known() const { return known_; }
  const std::vector<Feature>& features() const { return features_; }
  const std::vector<Index>& free_vertices() const { return free_; }
  const std::vector<Anchor>& anchors() const { return anchors_; }  ///< on vertices whose position is unknown
  int residual_corrections() const { return residual_corrections_; }
  /// How the patch's rings were cut, for other systems over them.
  const std::shared_ptr<BisectionTree>& cuts() const { return cuts_; }
  /// Null where nothing is free. Of a shared operator, `H` has rows for maps that are known here.
  const AffineOperator* operators() const { return operators_ ? &operators_->rows() : nullptr; }

 private:
  // Steps of the set-up.
  bool share(const ConstrainedSystem& other, const VertexStates& states, std::span<const Anchor> all_anchors,
             const Context& context);
  void find_known(const VertexStates& states, std::span<const Anchor> all_anchors);
  void build_operator(const OperatorOptions& options, const Context& context);
  void build_system(Density density, double stiffness, const Context& context);
  double free_area() const;
  SparseRows stiffness_rows(Density density, double stiffness);
  SparseRows anchor_rows(Density density);
  void prepare_similarities(const Context& context);
  Eigen::Index shared_row(Eigen::Index s) const;
  void impose_similarities(Columns& y) const;
  void place_features(const Columns& y, Points& out) const;
  Index count_inverted(const Columns& maps) const;
  void factorise(SolverBackend backend, DeformerSummary& summary, const Context& context);
  Index count_degenerate() const;

  /// One column block for the rows of E_L and anchors, one for those of E_R: right-hand sides or residuals.
  struct Rows {
    Columns laplacian, smoothness;
  };
  Rows right_hand_side(const Known& values, const MapField& field, const Context& context) const;
  Columns laplacian_rows(const Known& values, const Columns& m, const MapField& field,
                         const Context& context) const;
  void add_stretch(const Columns& stretch, Eigen::Ref<Columns> bars) const;
  void add_targets(Rows& rows) const;
  Columns apply_transposed(const Rows& rows, const Context& context) const;
  Rows residual_rows(const Rows& rhs, const Columns& y, const Context& context) const;
  Columns solve(const Rows& rhs, const SolveSteps& steps, const Context& context) const;
  void place(const Columns& y, const Known& values, std::span<const VertexConstraint> constraints, Points& out,
             const Context& context) const;
  double max_transform_deviation(std::span<const VertexConstraint> constraints, const Points& positions) const;

  std::vector<Index> free_;  ///< global indices, ascending
  // Perhaps shared with other systems.
  std::shared_ptr<const CutPatch> cut_;
  std::shared_ptr<const PatchOperator> operators_;
  std::optional<PatchPart> part_;         ///< of a shared patch that is larger than need be
  std::optional<SparseRows> fewer_maps_;  ///< H where that of the operator has more
  const SparseRows& H() const { return fewer_maps_ ? *fewer_maps_ : operators_->rows().H(); }
  KnownParts known_;
  double region_size_ = 1;  ///< √ of the area of the faces that touch a free vertex
  /// Edges with rows of stiffness.
  struct EdgeRow {
    std::array<Index, 2> ends;
    double weight;
  };
  std::vector<EdgeRow> edge_rows_;
  SparseRows stiffness_rows_;           ///< rows × nodes
  std::vector<Anchor> anchors_;         ///< on vertices whose position is unknown
  std::vector<double> anchor_weights_;  ///< of their rows
  SparseRows E_, A_L_, A_L_transposed_, G_, G_transposed_;
  std::unique_ptr<LinearSolver> solver_;
  std::shared_ptr<BisectionTree> cuts_ = std::make_shared<BisectionTree>();  ///< of the patch's rings
  double normal_one_norm_ = 0;
  int residual_corrections_ = 1;

  // Features: four shared columns each, the last ones of y.
  std::vector<Feature> features_;
  std::vector<Index> feature_column_;     ///< the first of them, or -1 for a feature that nothing reaches
  Index shared_begin_ = 0;                ///< the first shared column of all
  std::vector<Index> similarities_;       ///< features that are similarities and have columns
  Eigen::MatrixXd similarity_response_;   ///< N⁻¹ e_s for their columns s, N = AᵀA; columns × 4 per similarity
  Eigen::MatrixXd similarity_stiffness_;  ///< inverse of its rows s: what moving them costs, the rest following
};

}  // namespace meshgraft
