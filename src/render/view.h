#pragma once

#include <Eigen/Core>

#include "scene.h"

namespace meshgraft::render {

/// The camera and the lights. Coordinates are those of the camera: to the right, up and back from the eye, in
/// units of the scene's radius, so that single precision suffices anywhere.
struct View {
  Eigen::Vector3d eye;   ///< in the coordinates of the scene
  Eigen::Matrix3d axes;  ///< as rows: right, up and back, of unit length
  double scale = 1.0;    ///< the radius of the scene
  Vec3 middle;           ///< of the scene
  Vec3 zenith;           ///< away from the ground
  float ground = 0.0f;   ///< height along the zenith
  Vec3 to_key, to_fill;
  float tangent = 0.0f;               ///< of half the vertical field of view
  float width = 1.0f, height = 1.0f;  ///< of the picture, in pixels

  Vec3 coordinates_of(const Eigen::RowVector3d& position) const {
    return (axes * ((position.transpose() - eye) / scale)).cast<float>();
  }

  /// Returns the direction to a place in the picture, in pixels from its upper left corner. Its last coordinate
  /// is -1.
  Eigen::Vector3d direction_to(double x, double y) const {
    return {tangent * (2 * x - width) / height, tangent * (1 - 2 * y / height), -1.0};
  }

  /// Returns the place in the picture of a point ahead of the eye.
  Eigen::Vector2d place_of(const Eigen::Vector3d& point) const {
    const double unit = -0.5 * height / (tangent * point.z());
    return {0.5 * width + unit * point.x(), 0.5 * height - unit * point.y()};
  }

  /// Returns the distance between two pixels on a surface at this point that is seen from straight above.
  float spacing_at(const Vec3& point) const { return 2.0f * tangent * point.norm() / height; }
};

/// Places the camera so that it sees all of the scene, or of the camera's box. Throws Error(usage) for a camera
/// without direction.
View fit_view(const Scene& scene, const RenderOptions& options);

}  // namespace meshgraft::render
