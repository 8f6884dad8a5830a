#pragma once

#include <memory>

#include <Eigen/Core>

#include <meshgraft/core/context.h>
#include <meshgraft/linalg/linear_solver.h>

#include "block_rows.h"

namespace meshgraft {

/// Four right-hand sides, or solutions, at once: one row per row of the nodes, zero where it is padding.
using FourColumns = Eigen::Matrix<double, Eigen::Dynamic, 4, Eigen::RowMajor>;

/// A symmetric positive definite matrix N = L + D + Lᵀ in blocks of nodes, D the nodes' own and L what couples
/// each with those that a forward sweep meets first. L is kept once: a visit of a row of it serves L and Lᵀ.
class BlockMatrix {
 public:
  virtual ~BlockMatrix() = default;

  /// Throws Error(unsolvable) if a block of D is not positive definite.
  virtual void set_values(const NormalMatrix& lower, const Context& context) = 0;

  /// y = N x.
  virtual void multiply(const FourColumns& x, FourColumns& y, const Context& context) const = 0;

  /// A Gauss-Seidel sweep for N z = r from z = 0: z = (L + D)⁻¹ r. Leaves s = r − N z.
  virtual void sweep_forward(const FourColumns& r, FourColumns& z, FourColumns& s,
                             const Context& context) const = 0;

  /// A sweep the other way after a correction e of z: z += e + (D + Lᵀ)⁻¹ (s − N e) where s = r − N z; s is
  /// used up.
  virtual void sweep_backward(const FourColumns& e, FourColumns& s, FourColumns& z,
                              const Context& context) const = 0;

  virtual std::int64_t bytes() const = 0;

  // For coarse matrices: what a node has in D and, beside its lists of nodes before it, in L. Blocks are
  // width×width, row by row.
  virtual const double* diagonal_block(Index node) const = 0;
  virtual const double* blocks_before(Index node) const = 0;
  virtual const double* entries_before(Index node) const = 0;
};

/// `order` must outlive the matrix.
std::unique_ptr<BlockMatrix> make_block_matrix(const NodeOrder& order);

}  // namespace meshgraft
