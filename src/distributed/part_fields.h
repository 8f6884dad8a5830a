#pragma once

#include <memory>
#include <optional>
#include <vector>

#include <Eigen/SparseCore>

#include "label_sums.h"
#include "linalg/sparse.h"
#include "parallel_solver.h"
#include "part.h"

namespace meshgraft::distributed {

/// A matrix over the vertices of a part, restricted to some of them, with its solver. Rows are those of the own
/// vertices.
class VertexSystem {
 public:
  /// `rows` is own vertices × local vertices, `unknown` flags the local vertices that are solved for.
  VertexSystem(const Communicator& comm, const Part& part, SparseRows rows, const Flags& unknown,
               const ParallelSolverOptions& options);

  bool empty() const { return unknowns_.total() == 0; }
  /// Returns own rows × fields (local vertices × k).
  Columns multiply(const Columns& fields) const;
  /// Solves for a right-hand side of own vertices × k. Returns values of the local vertices, 0 where nothing is
  /// unknown.
  Columns solve(const Columns& rhs, double tolerance) const;

 private:
  const Part& part_;
  SparseRows rows_;
  Flags unknown_;
  Halo unknowns_;
  std::optional<ParallelSolver> solver_;
};

/// Scalar fields on a surface that is divided among the ranks, as `SurfaceFields` has them. All functions take
/// and return values of the local vertices.
class PartFields {
 public:
  /// `given` flags the local vertices with given values. Without a smoothing length, `smooth` must not be
  /// called.
  PartFields(const Communicator& comm, const Part& part, const Flags& given, double tolerance,
             std::optional<double> smoothing_length_rel);

  Columns spread(const Columns& values) const;
  Columns smooth(const Columns& values) const;

  const std::vector<double>& areas() const { return areas_; }
  /// Returns the component of each local vertex by its label, -1 for isolated vertices.
  const std::vector<Number>& component() const { return component_; }
  bool is_constrained(Number component) const { return sums_.at(component)[2] > 0; }
  double free_area(Number component) const { return sums_.at(component)[0]; }

 private:
  SparseRows energy_rows(double bending_length_rel) const;
  LabelValues widths(double bending_length_rel) const;
  void set_up_smoothing(double length_rel);

  const Communicator& comm_;
  const Part& part_;
  Flags given_;
  double tolerance_;
  std::vector<double> areas_;
  std::vector<Number> component_;
  LabelValues sums_;              ///< area without given values, area with given values, number of given values
  SparseRows tension_, bending_;  ///< own rows of K and K M⁻¹ K
  std::optional<VertexSystem> spreading_, smoothing_;
};

}  // namespace meshgraft::distributed
