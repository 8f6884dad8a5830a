#pragma once

#include <cstddef>
#include <memory>
#include <span>
#include <vector>

#include <meshgraft/deform/deformer.h>

namespace meshgraft {

struct ProxyOptions {
  DeformerOptions deformer{};  ///< of the solve on the proxy
  /// About how many vertices of the region, with the handles in it, the proxy has. It has more where handles
  /// and rims need them, and where the topology allows no fewer; at least 50, at most all.
  Index vertices = 4000;
};

/// Seconds per stage and facts of the set-up.
struct ProxySummary {
  Index vertices = 0;       ///< of the proxy, with those around the region
  Index free_vertices = 0;  ///< of the mesh: their positions follow from the proxy's
  double spacing = 0;       ///< edge length that the proxy was made for, model units
  double decimate_seconds = 0;
  double skin_seconds = 0;       ///< weights by which the mesh follows the proxy
  std::size_t skin_entries = 0;  ///< number of these weights
  DeformerSummary deformer{};    ///< of the proxy
};

/// Deforms a region by way of a decimated proxy: a coarse triangulation on some of its vertices is deformed by
/// a `Deformer`, and the other vertices follow its positions and local maps, x_v = Σ_k w_k (x_k + M_k (p_v −
/// p_k)), with smooth weights over the proxy's vertices that are near along the surface. The set-up takes a
/// fraction of the time and memory of the whole region's, and the result approaches the `Deformer`'s as the
/// proxy grows (docs/performance.md has figures); with a proxy of all vertices it is that.
///
/// Exact like the `Deformer`'s are: positions of handles and of what is fixed, and affine maps that all
/// constraints follow.
class ProxyDeformer {
 public:
  /// As `Deformer`'s. Throws what that throws, with the mesh's own vertex numbers, and looks at more of the
  /// surroundings, where there may be a coordinate that is not finite; Error(unsolvable) where the region could
  /// be solved but no proxy of that size.
  ProxyDeformer(const Points& rest, const Triangles& triangles, const Region& region,
                const ProxyOptions& options = {}, const Context& context = {});

  /// As `Deformer::with_constraints`.
  static ProxyDeformer with_constraints(const Points& rest, const Triangles& triangles,
                                        std::span<const Index> region,
                                        std::span<const VertexConstraint> constraints,
                                        std::span<const Anchor> anchors, std::span<const Feature> features,
                                        const ProxyOptions& options = {}, const Context& context = {});

  ProxyDeformer(ProxyDeformer&&) noexcept;
  ProxyDeformer& operator=(ProxyDeformer&&) noexcept;
  ~ProxyDeformer();

  /// New positions, n×3, for one pose per handle. Vertices outside the region and fixed ones keep their bits;
  /// handle vertices are exactly at `pose · p`. A `report` is of the solve on the proxy.
  Points evaluate(std::span<const HandlePose> poses, const Context& context = {},
                  EvaluationReport* report = nullptr) const;
  /// The same into the caller's memory (n×3; throws Error(usage) for another shape).
  void evaluate(std::span<const HandlePose> poses, Points& positions_out, const Context& context = {},
                EvaluationReport* report = nullptr) const;

  /// New positions for constraints per vertex, in the order they were given to `with_constraints`.
  Points evaluate(std::span<const VertexConstraint> constraints, const Context& context = {},
                  EvaluationReport* report = nullptr) const;

  const ProxySummary& summary() const;

  /// Vertices of the mesh whose position follows from the proxy's, ascending.
  std::span<const Index> free_vertices() const;

  /// The proxy: its vertices, as numbers of the mesh's (ascending), and its triangles on them.
  std::span<const Index> proxy_vertices() const;
  const Triangles& proxy_triangles() const;

  /// Lower bound of the condition number of the proxy's AᵀA; costs a few solves.
  double condition_estimate(const Context& context = {}) const;

 private:
  ProxyDeformer();
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace meshgraft
