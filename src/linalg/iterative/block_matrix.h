#pragma once

#include <memory>

#include <meshgraft/core/context.h>
#include <meshgraft/linalg/linear_solver.h>

#include "block_rows.h"
#include "four_columns.h"

namespace meshgraft {

/// A symmetric positive definite matrix N = L + D + Lᵀ in blocks of nodes. D holds the nodes' own blocks. L
/// couples each node with those that a forward sweep meets first. L is stored once, and each visit to a row
/// of L is used for L and Lᵀ. Sweeps, which precondition, read L in single precision, because they wait for
/// memory. They compute in double precision with D, so that they stay symmetric and positive definite.
class BlockMatrix {
 public:
  virtual ~BlockMatrix() = default;

  /// Throws Error(unsolvable) if a block of D is not positive definite.
  virtual void set_values(const NormalMatrix& lower, const Context& context) = 0;

  /// Rounds L for sweeps. It is apart from `set_values`, so that the caller can free memory before.
  virtual void prepare_sweeps(const Context& context) = 0;

  /// Computes y = N x.
  virtual void multiply(const FourColumns& x, FourColumns& y, const Context& context) const = 0;

  /// Performs a Gauss-Seidel sweep for N z = r from z = 0: z = (L + D)⁻¹ r. Sets s = r − N z.
  virtual void sweep_forward(const FourColumns& r, FourColumns& z, FourColumns& s,
                             const Context& context) const = 0;

  /// Performs a backward sweep after a correction e of z: z += e + (D + Lᵀ)⁻¹ (s − N e), where s = r − N z.
  /// Overwrites s.
  virtual void sweep_backward(const FourColumns& e, FourColumns& s, FourColumns& z,
                              const Context& context) const = 0;

  virtual std::int64_t bytes() const = 0;

  // For coarse matrices: a node's block of D, and its blocks and entries of L in the order of its lists of
  // nodes before it. Blocks are width×width, row-major.
  virtual const double* diagonal_block(Index node) const = 0;
  virtual const double* blocks_before(Index node) const = 0;
  virtual const double* entries_before(Index node) const = 0;
};

/// Makes an empty matrix. `order` must outlive it.
std::unique_ptr<BlockMatrix> make_block_matrix(const NodeOrder& order);

}  // namespace meshgraft
