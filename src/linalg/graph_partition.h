#pragma once

#include <vector>

#include <meshgraft/linalg/linear_solver.h>

namespace meshgraft {

// METIS (Karypis & Kumar 1998). Both functions give the same result every time, and both stop waiting for it
// when a stop is requested: Error(cancelled).

/// Cuts a ordering graph `levels` times where the fewest edges cross, so that both sides of a cut have as many
/// unknowns.
BisectionTree bisect_graph(const OrderingGraph& graph, int levels, const Context& context = {});

/// Returns the unknowns of a matrix in the order of a nested dissection of its own graph (George 1973).
/// Throws Error(memory) for more entries than METIS can count.
std::vector<int> nested_dissection_order(const NormalMatrix& lower, const Context& context = {});

}  // namespace meshgraft
