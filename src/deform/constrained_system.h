#pragma once

#include <array>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include <meshgraft/deform/deformer.h>
#include <meshgraft/linalg/sparse.h>

#include "patch.h"
#include "solvability.h"

namespace meshgraft {

/// What is known of each vertex of the whole mesh before the solve.
struct VertexStates {
  std::vector<std::uint8_t> position, transform;
  std::vector<Index> feature;  ///< its number, or -1

  VertexStates(Index count, bool known)
      : position(static_cast<std::size_t>(count), known),
        transform(static_cast<std::size_t>(count), known),
        feature(static_cast<std::size_t>(count), -1) {}
};

/// Throws Error(input) at `place` unless 0 ≤ vertex < count.
void require_vertex(Index vertex, Index count, const std::string& place);

/// Maps F_i per vertex of the patch on the right-hand side; an empty field stands for I everywhere.
struct MapField {
  std::vector<Eigen::Matrix3d> smoothness;  ///< of E_R: (M_i − M_j) d = (F_i − F_j) d
  std::vector<Eigen::Matrix3d> stretch;     ///< of the stiffness: x_i − x_j = ½(F_i + F_j)(p_i − p_j)
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
  /// Fills the free and degenerate counts, the seconds and the solver's facts of `summary`.
  ConstrainedSystem(const Points& rest, const Triangles& triangles, const VertexStates& states,
                    std::span<const Anchor> anchors, std::span<const Feature> features,
                    const DeformerOptions& options, DeformerSummary& summary, const Context& context);

  /// Known displacements of nodes and known maps less I, from constraints.
  struct Known {
    Columns x, m;
  };
  Known known_values(std::span<const VertexConstraint> constraints) const;

  /// How the unknowns are solved for.
  struct SolveSteps {
    int corrections = 0;  ///< with the residual of the rectangular system, after the back-substitution
    const Columns* guess = nullptr;  ///< unknowns of a similar problem; an iterative solver starts there
  };
  Columns solve(const Known& values, const MapField& field, const SolveSteps& steps,
                const Context& context) const;
  /// The map T of each feature in a solution; I for those that nothing reaches.
  std::vector<Eigen::Matrix3d> feature_maps(const Columns& y) const;
  /// The local maps of a solution less I: rows 3v … 3v+2 are (M_v − I)ᵀ.
  Columns maps(const Columns& y, const Known& values, const Context& context) const;

  /// The field on the right-hand side, and unknowns near the solution if there are any at hand.
  struct Problem {
    MapField field;
    Columns guess;
  };
  /// Positions (n×3) for constraints that fit `states`; fills `report`'s measures if there is one.
  void evaluate(std::span<const VertexConstraint> constraints, const Problem& problem, Points& out,
                EvaluationReport* report, const Context& context) const;
  CouplingGraph coupling_graph() const;
  NormalMatrix normal_matrix(const Context& context) const;
  double condition_estimate(const Context& context) const;

  const Points& rest() const { return rest_; }
  const Patch& patch() const { return patch_; }
  const KnownParts& known() const { return known_; }
  const std::vector<Feature>& features() const { return features_; }
  const std::vector<Index>& free_vertices() const { return free_; }
  const AffineOperator* operators() const { return operators_.get(); }  ///< null where nothing is free

 private:
  // Steps of the set-up.
  void cut_patch(const Triangles& triangles, const VertexStates& states, int laplacian_order,
                 const Context& context);
  void take_anchors(std::span<const Anchor> all_anchors, const VertexStates& states);
  void build_operators(const OperatorOptions& options, const Context& context);
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
  Columns apply_transposed(const Rows& rows, const Context& context) const;
  Rows residual_rows(const Rows& rhs, const Columns& y, const Context& context) const;
  Columns solve(const Rows& rhs, const SolveSteps& steps, const Context& context) const;
  void place(const Columns& y, const Known& values, std::span<const VertexConstraint> constraints, Points& out,
             const Context& context) const;
  double max_transform_deviation(std::span<const VertexConstraint> constraints, const Points& positions) const;

  Points rest_;
  std::vector<Index> free_;  ///< global indices, ascending
  Patch patch_;
  KnownParts known_;
  double region_size_ = 1;  ///< √ of the area of the faces that touch a free vertex
  /// Edges with rows of stiffness.
  struct Bar {
    std::array<Index, 2> ends;
    double weight;
  };
  std::vector<Bar> bars_;
  SparseRows bar_rows_;                 ///< rows × nodes
  std::vector<Anchor> anchors_;         ///< on vertices whose position is unknown
  std::vector<double> anchor_weights_;  ///< of their rows
  std::unique_ptr<AffineOperator> operators_;
  SparseRows E_, A_L_, A_L_transposed_, G_, G_transposed_, P_transposed_;
  std::unique_ptr<LinearSolver> solver_;
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
