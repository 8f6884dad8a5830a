#pragma once

#include "scene.h"

namespace meshgraft::render {

/// The two shares of light that reach a point: of the sky, and of the key light. Few random rays measure them.
struct Light {
  float open = 0.0f, key = 0.0f;
};

/// The surface, ground or background that a sample of a picture shows. The colour is plain + open·by_open +
/// key·by_key.
struct Appearance {
  Vec3 plain = Vec3::Zero(), by_open = Vec3::Zero(), by_key = Vec3::Zero();
  Vec3 normal = Vec3::Zero(), point = Vec3::Zero();
  bool on_shape = false;

  /// Returns false for the background, which has a colour of its own.
  bool needs_light() const { return !normal.isZero(0); }

  Vec3 lit_by(const Light& light) const { return plain + light.open * by_open + light.key * by_key; }
};

}  // namespace meshgraft::render
