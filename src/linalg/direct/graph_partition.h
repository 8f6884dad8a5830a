#pragma once

#include <vector>

#include <meshgraft/linalg/linear_solver.h>

namespace meshgraft {

// METIS (Karypis & Kumar 1998). Both functions are deterministic. Both stop waiting for METIS when a stop is
// requested and throw Error(cancelled).

/// Bisects an ordering graph `levels` times. Each cut crosses few edges and leaves about the same number of
/// unknowns on both sides.
BisectionTree bisect_graph(const OrderingGraph& graph, int levels, const Context& context = {});

/// Returns the unknowns of a matrix in the order of a nested dissection of its own graph (George 1973).
/// Throws Error(memory) if there are more entries than METIS can count.
std::vector<int> nested_dissection_order(const NormalMatrix& lower, const Context& context = {});

}  // namespace meshgraft
