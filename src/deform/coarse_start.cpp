#include "coarse_start.h"

#include <algorithm>
#include <utility>
#include <vector>

#include <meshgraft/core/error.h>

#include "core/parallel.h"
#include "deform/solve/corotation.h"

namespace meshgraft {

namespace {

constexpr Index fewest_free = 30'000;  // below, the proxy takes as long as the steps that it saves
constexpr Index free_per_vertex = 10, most_vertices_of_start = 8000;
/// Most poses settle after 25 or fewer, tight bends after 60. Those that buckle take more, and their proxy may
/// buckle elsewhere.
constexpr int most_iterations_of_start = 100;

/// Returns the context without its progress, which is the region's own.
Context without_progress(Context context) {
  context.progress = {};
  return context;
}

}  // namespace

std::unique_ptr<const CoarseStart> CoarseStart::make(const RestMesh& rest, const Region& region,
                                                     std::span<const VertexConstraint> constraints, Index free,
                                                     const DeformerOptions& options, const Context& context) {
  if (free < fewest_free || !region.features.empty() || region.symmetric) return nullptr;
  ProxyOptions of_proxy{options, std::min(free / free_per_vertex, most_vertices_of_start)};
  of_proxy.deformer.method = DeformMethod::corotational;
  of_proxy.deformer.backend = SolverBackend::automatic;
  of_proxy.deformer.iterations = most_iterations_of_start;
  try {
    return std::unique_ptr<const CoarseStart>(new CoarseStart(
        ProxyDeformer({rest.points, rest.triangles, region, {constraints.begin(), constraints.end()}}, of_proxy,
                      without_progress(context))));
  } catch (...) {  // for any error, the region is solved without
    if (current_error().code() == ErrorCode::cancelled) throw;
    return nullptr;
  }
}

Columns CoarseStart::maps(std::span<const VertexConstraint> constraints, const Patch& patch,
                          const Context& context) const {
  Columns maps;
  try {
    EvaluationReport report;
    const std::vector<Eigen::Matrix3d> changes =
        proxy_.map_changes(constraints, without_progress(context), &report);
    if (report.last_rotation_change >= settled_change) return maps;
    maps.resize(3 * patch.size(), 3);
    parallel_blocks(
        patch.vertices.size(),
        [&](std::size_t begin, std::size_t end) {
          for (std::size_t v = begin; v < end; ++v)
            maps.middleRows<3>(3 * static_cast<Eigen::Index>(v)) = changes[patch.vertices[v]].transpose();
        },
        context, 4096);
  } catch (...) {
    if (current_error().code() == ErrorCode::cancelled) throw;
    maps.resize(0, 3);
  }
  return maps;
}

}  // namespace meshgraft
