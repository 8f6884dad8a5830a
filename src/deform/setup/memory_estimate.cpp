#include "memory_estimate.h"

#include <algorithm>
#include <cmath>

#include <meshgraft/core/error.h>

#include "deform/facts.h"

namespace meshgraft {

namespace {

bool by_eigen(SolverBackend backend) {
  return (backend == SolverBackend::automatic ? available_backends().front() : backend) == SolverBackend::eigen;
}

}  // namespace

/// The factor of a surface's matrix has O(n log n) entries under nested dissection (George 1973). The
/// constants are geometric means of measurements. Minimum degree, the only ordering that Eigen offers, grows
/// faster.
std::int64_t estimated_memory(Index free_vertices, const DeformerOptions& options) {
  if (free_vertices < 0) throw Error(facts::deform::NegativeCount{.count = free_vertices});
  if (free_vertices == 0) return 0;
  const double n = free_vertices, n_log_n = n * std::log2(std::max(n, 2.0));
  const bool noise = options.operators.degenerate == DegenerateTreatment::ft05_noise;
  if (options.backend == SolverBackend::iterative) return std::llround((noise ? 1150 : 1450) * n);
  if (by_eigen(options.backend)) return std::llround((noise ? 230 : 600) * std::pow(n / 1000, 0.2) * n_log_n);
  return std::llround((noise ? 280 : 560) * n_log_n);
}

namespace {

/// Returns the bytes of the whole set-up and a solve, scaled from measurements at a million vertices. The
/// fields are solved by iterations, too.
double iterative_memory(Index free_vertices, const DeformerOptions& options) {
  const bool noise = options.operators.degenerate == DegenerateTreatment::ft05_noise;
  const double of_fields = options.method == DeformMethod::ft05 ? 0 : 2000;
  return (of_fields + (noise ? 4000 : 5200)) * free_vertices;
}

/// Returns the bytes that the steps of a shell take, after measurements from 50,000 to 250,000 vertices.
double shell_memory(Index free_vertices, const DeformerOptions& options) {
  if (options.method != DeformMethod::shell) return 0;
  return 700.0 * free_vertices * std::log2(std::max(free_vertices, 2));
}

}  // namespace

SolvePath choose_path(Index free_vertices, const DeformerOptions& options, std::uint64_t memory) {
  // `corotational` solves a dozen times for a pose, so a factorisation pays for larger regions.
  const Index most_for_direct = is_corotational(options.method) ? 2'000'000 : 1'000'000;
  const double available = static_cast<double>(memory) - shell_memory(free_vertices, options);
  const bool direct_fits = 2.0 * static_cast<double>(estimated_memory(free_vertices, options)) <= available,
             iterative_fits = iterative_memory(free_vertices, options) <= available;
  switch (options.backend) {
    case SolverBackend::automatic:
      if (direct_fits && free_vertices < most_for_direct) return SolvePath::direct;
      return iterative_fits ? SolvePath::iterative : SolvePath::proxy;
    case SolverBackend::iterative: return iterative_fits ? SolvePath::iterative : SolvePath::proxy;
    default: return direct_fits ? SolvePath::direct : SolvePath::proxy;
  }
}

bool factors_of_fields_fit(Index free_vertices, const DeformerOptions& options, std::uint64_t memory) {
  if (by_eigen(SolverBackend::automatic)) return false;  // its factors take far more
  constexpr double per_level = 105;  // bytes per vertex and level of the dissection, from a million vertices
  const double of_factors = per_level * free_vertices * std::log2(std::max(free_vertices, 2));
  return iterative_memory(free_vertices, options) + of_factors <= static_cast<double>(memory);
}

Index proxy_vertices_for(const DeformerOptions& options, std::uint64_t memory) {
  constexpr Index fewest = 2000, most = 64'000;
  Index vertices = most;
  while (vertices > fewest &&
         2.0 * static_cast<double>(estimated_memory(vertices, options)) > static_cast<double>(memory) / 4)
    vertices /= 2;
  return std::max(vertices, fewest);
}

}  // namespace meshgraft
