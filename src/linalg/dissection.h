#pragma once

#include <cstdint>
#include <mutex>
#include <vector>

#include <meshgraft/linalg/linear_solver.h>

namespace meshgraft {

/// Nested dissection of a matrix by the cuts of a coupling graph: for each unknown the number of its set, sets
/// in the order in which they are to be eliminated. The graph is bisected (METIS), which is quick because it is
/// small; each cut's separator is then the fewest unknowns that touch all entries of the matrix across the cut,
/// hence as thick as the matrix's couplings are long. Separators as thin as the graph's own would leave sides
/// coupled, with four times the fill.
std::vector<std::int64_t> dissect(const NormalMatrix& lower, const CouplingGraph& graph,
                                  const Context& context = {});

/// Held by whoever calls METIS, directly or through CHOLMOD: it seeds and draws the C library's random numbers,
/// so its cuts are the same every time only while nobody else does.
std::mutex& metis_mutex();

}  // namespace meshgraft
