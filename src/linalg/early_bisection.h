#pragma once

#include <future>

#include <meshgraft/linalg/linear_solver.h>

namespace meshgraft {

/// Begins to fill the bisection tree of an ordering graph, on a thread of its own if one can be had, so that
/// the caller can assemble the matrix meanwhile. Does nothing if the backend would not fill the tree, if it is
/// filled, or if one thread is asked for. The graph must stay as it is until the result is ready, and `get`
/// throws Error(cancelled) if a stop was requested. The result's destructor waits.
std::future<void> begin_bisection(const OrderingGraph& graph, SolverBackend backend, const Context& context);

}  // namespace meshgraft
