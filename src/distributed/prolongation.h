#pragma once

#include <Eigen/Core>

#include "parallel_solver.h"

namespace meshgraft::distributed {

/// The first coarse grid of a matrix: an affine function of position for each aggregate of vertices, blended
/// between aggregates, as `CoarseSpace` has it. An aggregate lies within one rank.
struct Prolongation {
  MatrixRows rows;             ///< own unknowns × coarse unknowns: the entries of the matrix P
  std::vector<Number> starts;  ///< where each rank's coarse unknowns start, four for each aggregate
  /// Own coarse unknowns × 4: P times this gives the functions x, y, z and 1.
  Eigen::MatrixXd affine;
};

Prolongation make_prolongation(const Communicator& comm, const UnknownNodes& nodes);

}  // namespace meshgraft::distributed
