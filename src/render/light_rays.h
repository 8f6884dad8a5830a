#pragma once

#include <cstdint>

#include <meshgraft/core/context.h>

#include "appearance.h"
#include "mesh/ray_tracer.h"
#include "occluders.h"
#include "view.h"

namespace meshgraft::render {

/// The rays that measure the light at a point. A set of points shares low-discrepancy sequences (the plastic
/// sequence, Roberts 2018), shifted at random, and each point has a part of them: its rays are the `number`-th
/// ones. So the rays are even over the hemisphere and the key light, and differ between sets.
struct RaySet {
  std::uint32_t set, number;
  int to_sky, to_key;  ///< numbers of rays
};

/// Traces rays from points of a scene to its lights.
class LightRays {
 public:
  LightRays(const std::vector<Vec3>& points, const Triangles& triangles, const View& view,
            const Context& context);

  /// Returns the height above a surface at which rays begin.
  float lift() const { return lift_; }

  Light light_at(const Appearance& sample, const RaySet& rays) const;

 private:
  LightRays(const Occluders& occluders, const View& view, const Context& context);

  const View& view_;
  RayTracer tracer_;
  float lift_;
};

}  // namespace meshgraft::render
