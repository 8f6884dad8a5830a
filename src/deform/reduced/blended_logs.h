#pragma once

#include "deform/solve/rotation_field.h"
#include "deform/solve/rotations.h"
#include "linalg/sparse.h"

namespace meshgraft {

/// The logarithms of the handles' transforms, and of the fits of components without a given transform.
struct BlendedLogs {
  Eigen::Matrix3d reference = Eigen::Matrix3d::Identity();
  Columns handles;  ///< handles × 9: rotation vector, logarithm of the stretch
  Columns fits;     ///< components without a given map × 9

  /// Returns the map at a point with weights (one per handle) or, if `component` is not negative, that of the
  /// component.
  BlendedMap map_at(const Columns& influence, Eigen::Index point, Index component = -1) const {
    Eigen::Matrix<double, 1, 9> log;
    if (component >= 0)
      log = fits.row(component);
    else
      log = influence.row(point) * handles;
    return {rotation_exp(log.head<3>().transpose()) * reference, stretch_exp(log.tail<6>().transpose())};
  }
};

}  // namespace meshgraft
