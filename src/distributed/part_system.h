#pragma once

#include <array>
#include <memory>
#include <optional>
#include <vector>

#include <meshgraft/deform/deform_problem.h>
#include <meshgraft/distributed.h>
#include <meshgraft/linalg/linear_solver.h>
#include <meshgraft/operators/affine_operator.h>

#include "linalg/sparse.h"
#include "parallel_solver.h"
#include "part.h"

namespace meshgraft::distributed {

/// The maps F_v of a field on the right-hand side, minus I, for all local vertices: rows 3v … 3v+2 are
/// (F_v − I)ᵀ. A field without rows stands for I everywhere.
struct PartField {
  Columns maps;
  bool smooth = true;  ///< maps count for E_R, and not for edges with stiffness alone
};

/// The given values at all local vertices of a part.
struct PartValues {
  Columns displacement;  ///< x − p of given positions, patch units; 0 elsewhere
  Columns maps;          ///< M − I of given transforms: rows 3v … 3v+2 are (M_v − I)ᵀ; 0 elsewhere
};

/// The least-squares problem of a deformation, as `ConstrainedSystem` describes it, without features. Each row
/// belongs to the rank that owns its vertex, or the first vertex of its pair. Each rank assembles the rows of
/// its part by the same code as on one machine. The columns of a rank are those of its own vertices.
class PartSystem {
 public:
  /// Throws on all ranks what the assembly throws on one of them.
  PartSystem(const Communicator& comm, const Part& part, const std::vector<Anchor>& anchors,
             const DistributedOptions& options);

  /// Solves for the unknowns: own columns × 3. `guess` is null or a similar solution.
  Columns solve(const PartValues& values, const PartField& field, int corrections, const Columns* guess) const;

  /// Returns the displacements of the own vertices in a solution (patch units), given ones included.
  Columns displacements(const Columns& y, const PartValues& values) const;
  /// Returns the local maps of the own vertices minus I: rows 3v … 3v+2 are (M_v − I)ᵀ.
  Columns maps(const Columns& y, const PartValues& values) const;
  /// Returns ‖Aᵀ(b − A y)‖ / ‖Aᵀ b‖, or 0 for a zero right-hand side.
  double residual(const Columns& y, const PartValues& values, const PartField& field) const;

  const AffineOperator& rows() const { return *rows_; }
  /// Returns the solver, or null if nothing is unknown.
  const ParallelSolver* solver() const { return solver_ ? &*solver_ : nullptr; }
  Number unknowns() const { return columns_.total(); }
  const Halo& columns() const { return columns_; }
  Number degenerate_vertices() const { return degenerate_vertices_; }
  /// Returns the seconds that summing up the matrix and setting up the preconditioner took.
  double factorise_seconds() const { return factorise_seconds_; }

 private:
  /// Right-hand sides or residuals of the own rows of E_L, stiffness and anchors. Those of E_R are P times
  /// maps, three rows per local vertex, which are a third as many numbers.
  struct Rows {
    Columns laplacian, maps;
  };
  void build_operator(const DeformerOptions& options);
  std::vector<int> number_columns();
  void build_system(const DeformerOptions& options);
  void find_stiffness_scales(const DeformerOptions& options);
  void list_edge_rows(const DeformerOptions& options);
  SparseRows stiffness_rows() const;
  SparseRows unknowns_of_nodes() const;
  SparseRows anchor_rows(const SparseRows& G, Density density);
  void factorise();
  void weigh_anchors();
  UnknownNodes unknown_nodes() const;

  Rows right_hand_side(const PartValues& values, const PartField& field) const;
  Columns apply_transposed(const Rows& rows) const;
  Rows residual_rows(const Rows& rhs, const Columns& y) const;
  Columns with_halo(const Columns& own) const;
  Columns maps_of(const Columns& y) const;

  const Communicator& comm_;
  const Part& part_;
  std::vector<Anchor> anchors_;  ///< at own vertices with an unknown position, by local index
  std::vector<double> anchor_weights_;
  std::optional<AffineOperator> rows_;
  double mean_edge_length_ = 1, region_size_ = 1;
  struct EdgeRow {
    std::array<Index, 2> ends;
    double weight;
  };
  std::vector<EdgeRow> edge_rows_;
  std::vector<double> stiffness_scales_;  ///< of the local vertices
  Halo columns_;
  std::vector<int> column_;               ///< per node: local column, or -1
  SparseRows L_, delta_, P_, stiffness_;  ///< own rows, in place of those of `rows_`
  SparseRows A_L_;                        ///< rows of E_L, stiffness and anchors × local columns
  std::optional<ParallelSolver> solver_;
  Preconditioner preconditioner_;
  double tolerance_;
  Number degenerate_vertices_ = 0;
  double factorise_seconds_ = 0;
};

}  // namespace meshgraft::distributed
