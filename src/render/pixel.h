#pragma once

#include "surface.h"

namespace meshgraft::render {

/// A pixel's colour is plain + open·by_open + key·by_key. The two shares of light come from few random rays.
/// They are stored separately, so that they can be smoothed over neighbouring pixels without blurring the
/// picture.
struct Pixel {
  Vec3 plain = Vec3::Zero(), by_open = Vec3::Zero(), by_key = Vec3::Zero();
  Vec3 normal = Vec3::Zero(), point = Vec3::Zero();
  float open = 0.0f, key = 0.0f;
  float cover = 0.0f;  // 1 on the shapes

  Pixel& operator+=(const Pixel& other) {
    plain += other.plain;
    by_open += other.by_open;
    by_key += other.by_key;
    normal += other.normal;
    point += other.point;
    open += other.open;
    key += other.key;
    cover += other.cover;
    return *this;
  }
  Pixel& operator*=(float factor) {
    plain *= factor;
    by_open *= factor;
    by_key *= factor;
    normal *= factor;
    point *= factor;
    open *= factor;
    key *= factor;
    cover *= factor;
    return *this;
  }
};

}  // namespace meshgraft::render
