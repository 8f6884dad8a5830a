#pragma once

#include <cstdint>

#include <meshgraft/deform/deform_problem.h>

namespace meshgraft {

/// Ways to solve a region.
enum class SolvePath {
  direct,     ///< by a factorisation of its matrix
  iterative,  ///< the same solution by an iterative solver (SolverBackend::iterative)
  proxy,      ///< on a decimated proxy, which the region follows (ProxyDeformer)
};

/// Chooses the way to solve a region with that many free vertices; `memory` is in bytes. With
/// `SolverBackend::automatic` it is the direct solve, for fewer than a million free vertices (two million for
/// `corotational`), if its set-up fits the memory. Otherwise it is iterations if those fit, and else a proxy. A
/// backend that is asked for is kept, unless it does not fit; then it is a proxy.
SolvePath choose_path(Index free_vertices, const DeformerOptions& options, std::uint64_t memory);

/// Returns whether the memory (bytes) suffices to factorise the systems of the scalar fields in a region that
/// is solved by iterations. At a million vertices that is faster than iterations.
bool factors_of_fields_fit(Index free_vertices, const DeformerOptions& options, std::uint64_t memory);

/// Returns the approximate number of vertices with which a proxy's solve takes a quarter of the memory
/// (bytes); at least 2,000.
Index proxy_vertices_for(const DeformerOptions& options, std::uint64_t memory);

}  // namespace meshgraft
