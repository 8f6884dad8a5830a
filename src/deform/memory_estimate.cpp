#include <meshgraft/deform/memory_estimate.h>

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include <meshgraft/core/error.h>

namespace meshgraft {

namespace {

bool by_eigen(SolverBackend backend) {
  return (backend == SolverBackend::automatic ? available_backends().front() : backend) == SolverBackend::eigen;
}

}  // namespace

/// The factor of a surface's matrix has of the order of n log n entries under nested dissection (George 1973);
/// the factors are the geometric middle of what was measured. Minimum degree, which Eigen has alone, grows
/// faster.
std::int64_t estimated_memory(Index free_vertices, const DeformerOptions& options) {
  if (free_vertices < 0)
    throw Error(ErrorCode::input, fmt::format("{} free vertices are not a number of vertices", free_vertices));
  if (free_vertices == 0) return 0;
  const double n = free_vertices, n_log_n = n * std::log2(std::max(n, 2.0));
  const bool noise = options.operators.degenerate == DegenerateTreatment::ft05_noise;
  if (by_eigen(options.backend)) return std::llround((noise ? 230 : 600) * std::pow(n / 1000, 0.2) * n_log_n);
  return std::llround((noise ? 255 : 635) * n_log_n);
}

}  // namespace meshgraft
