#pragma once

#include <cstddef>
#include <memory>
#include <span>
#include <vector>

#include <meshgraft/deform/deformer.h>

namespace meshgraft {

struct ProxyOptions {
  DeformerOptions deformer{};  ///< options of the solve on the proxy
  /// Approximate number of vertices that the proxy has in the region, handles included; at least 50, at most
  /// all. It has more where handles and the region's boundary need them, and where the topology allows no
  /// fewer.
  Index vertices = 4000;
};

/// Seconds per stage and figures of the set-up.
struct ProxySummary {
  Index vertices = 0;       ///< vertices of the proxy, including those around the region
  Index free_vertices = 0;  ///< vertices of the mesh whose positions follow from the proxy's
  double spacing = 0;       ///< edge length for which the proxy was made, model units
  double decimate_seconds = 0;
  double skin_seconds = 0;       ///< time for the weights by which the mesh follows the proxy
  std::size_t skin_entries = 0;  ///< number of these weights
  DeformerSummary deformer{};    ///< set-up of the proxy's Deformer
};

/// Deforms a region by way of a decimated proxy. A `Deformer` deforms a coarse triangulation of some of its
/// vertices. The other vertices follow the proxy's positions and local maps,
/// x_v = Σ_k w_k (x_k + M_k (p_v − p_k)).
/// The weights w_k are smooth, and non-zero only for proxy vertices that are near along the surface.
///
/// The set-up takes a fraction of the time and memory of the whole region's. The result approaches the
/// `Deformer`'s as the proxy grows (docs/performance.md has figures), and equals it with a proxy of all
/// vertices.
///
/// As with the `Deformer`, positions of handles and of fixed vertices are exact, and so are affine maps that
/// all constraints follow.
class ProxyDeformer {
 public:
  /// Takes the same problem as `Deformer` and throws the same errors, with the mesh's own vertex indices.
  /// It reads a larger neighbourhood of the region, so that non-finite coordinates there are errors, too.
  /// Throws Error(unsolvable) with the id deform.no_proxy where the region could be solved but no proxy of that
  /// size.
  explicit ProxyDeformer(DeformProblem problem, const ProxyOptions& options = {}, const Context& context = {});
  /// Does the same for a region with handles. `rest` is n×3, `triangles` m×3.
  ProxyDeformer(const Points& rest, const Triangles& triangles, const Region& region,
                const ProxyOptions& options = {}, const Context& context = {});

  ProxyDeformer(ProxyDeformer&&) noexcept;
  ProxyDeformer& operator=(ProxyDeformer&&) noexcept;
  ~ProxyDeformer();

  /// Returns new positions, n×3, for one pose per handle. Vertices outside the region and fixed ones keep
  /// their coordinates bit for bit; handle vertices are exactly at `pose · p`. `report` describes the solve
  /// on the proxy.
  Points evaluate(std::span<const HandlePose> poses, const Context& context = {},
                  EvaluationReport* report = nullptr) const;
  /// Writes the same positions to `positions_out` (n×3). Throws Error(usage) for another shape.
  void evaluate(std::span<const HandlePose> poses, Points& positions_out, const Context& context = {},
                EvaluationReport* report = nullptr) const;

  /// Returns new positions, n×3, for constraints per vertex, in the order of the problem. Those of handles
  /// come in the order of the handles and of their vertices.
  Points evaluate(std::span<const VertexConstraint> constraints, const Context& context = {},
                  EvaluationReport* report = nullptr) const;

  const ProxySummary& summary() const;

  /// Returns the vertices of the mesh whose position follows from the proxy's, ascending.
  std::span<const Index> free_vertices() const;

  /// Return the proxy: its vertices as indices into the mesh, ascending, and its triangles as indices into
  /// these vertices.
  std::span<const Index> proxy_vertices() const;
  const Triangles& proxy_triangles() const;

  /// Returns a lower bound of the condition number of the proxy's AᵀA, at the cost of a few solves.
  double condition_estimate(const Context& context = {}) const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace meshgraft
