#pragma once

#include <memory>
#include <vector>

#include <meshgraft/core/context.h>
#include <meshgraft/linalg/linear_solver.h>

#include "linalg/sparse.h"

namespace meshgraft {

/// Returns the given rows of a matrix.
SparseRows select_rows(const SparseRows& matrix, const std::vector<Index>& rows, const Context& context);

/// Factorises the square part of `rows` that belongs to the graph's groups. Each unknown is a vertex, and row k
/// is that of vertex `graph.group[k]`.
std::unique_ptr<LinearSolver> factorise_vertices(const SparseRows& rows, const OrderingGraph& graph,
                                                 SolverBackend backend, const Context& context);

/// Does the same for the vertices `unknown` with a solver that has analysed this pattern already.
void factorise_vertices(const SparseRows& rows, const std::vector<Index>& unknown, LinearSolver& analysed,
                        const Context& context);

}  // namespace meshgraft
