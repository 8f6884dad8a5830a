#pragma once

#include <span>

#include <Eigen/Core>

#include "surface.h"

namespace meshgraft::render {

/// The camera and the lights. Coordinates are relative to the scene's centre in units of its radius, so that
/// single precision suffices anywhere.
struct View {
  Eigen::Vector3d centre;
  double scale = 1.0;
  Vec3 eye, right, up, ahead;
  Vec3 zenith;  // away from the ground
  float tangent = 0.0f;
  float ground = 0.0f;  // height along the zenith
  Vec3 to_key, to_fill;
};

/// Throws Error(usage) for a camera without direction.
View fit_view(std::span<const Surface> surfaces, const RenderOptions& options);

/// Returns the distance between two pixels on a surface that is seen from straight above.
float spacing_at(const Vec3& point, const View& view, const RenderOptions& options);

}  // namespace meshgraft::render
