#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <span>
#include <vector>

#include <Eigen/Core>
#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>

#include <meshgraft/mesh/mesh.h>
#include <meshgraft/mesh/topology.h>

#include "limb_twist.h"
#include "linalg/sparse.h"

namespace meshgraft {

// The steps of `LimbTwist` at one triangle or one vertex.

/// A symmetric matrix as xx, yy, zz, yz, zx, xy.
using Tensor = Eigen::Matrix<double, 1, 6>;

/// Most groups of vertices with given maps in a component with discs. Level lines of the weights of more groups
/// enclose now one and now several of them, so that they tell no centre.
constexpr Index most_groups_around_discs = 2;

/// Slopes whose square is below this, × the steepest one's, have no certain direction.
constexpr double flattest = 1e-6;
/// Means along level lines reach over √(this) × √(free area), so that they go all around.
constexpr double reach_of_means = 1e4;

/// Returns a smooth ramp from 0 at `low` to 1 at `high`.
inline double ramp(double value, double low, double high) {
  const double x = std::clamp((value - low) / (high - low), 0.0, 1.0);
  return x * x * (3 - 2 * x);
}

/// Elongations from which on there is a limb, and of a limb for certain. The elongation is 1 where t points the
/// same way all along a level line, as on a pipe, and 0 where it points in all directions of a plane.
constexpr double least_elongation = 0.2, full_elongation = 0.6;

/// Returns 1 on a disc and 0 where there is none, and a smooth ramp in between. `flatness` is 1 where t points
/// in the directions of a plane, `outward` the cosine between t and the way from the centre.
inline double share_of_disc(double elongation, double flatness, double outward) {
  return (1 - ramp(elongation, 0, least_elongation)) * ramp(flatness, 0.2, 0.6) * ramp(outward, 0, 0.4);
}

inline Tensor to_tensor(const Eigen::Matrix3d& m) {
  return {m(0, 0), m(1, 1), m(2, 2), m(1, 2), m(2, 0), m(0, 1)};
}

inline Eigen::Matrix3d to_matrix(const Tensor& c) {
  Eigen::Matrix3d m;
  m << c[0], c[5], c[4], c[5], c[1], c[3], c[4], c[3], c[2];
  return m;
}

/// Returns the gradients of the hat functions of a triangle's corners in rows, or zero for a triangle that is
/// too thin to have any.
inline Eigen::Matrix3d hat_gradients(const Points& points, const Triangles& triangles, Eigen::Index t,
                                     double& area) {
  constexpr double thinnest = 1e-6;  // height, × the longest side
  Eigen::Vector3d side[3];
  double longest = 0;
  for (int k = 0; k < 3; ++k) {
    side[k] = (points.row(triangles(t, (k + 2) % 3)) - points.row(triangles(t, (k + 1) % 3))).transpose();
    longest = std::max(longest, side[k].squaredNorm());
  }
  const Eigen::Vector3d normal = side[0].cross(side[1]);
  const double twice = normal.norm();
  Eigen::Matrix3d gradients = Eigen::Matrix3d::Zero();
  area = 0;
  if (!(twice > thinnest * longest)) return gradients;
  area = twice / 2;
  for (int k = 0; k < 3; ++k) gradients.row(k) = normal.cross(side[k]).transpose() / (twice * twice);
  return gradients;
}

/// Returns columns of ones and zeros for groups of vertices, one for each of `count` groups. Beyond a fixed
/// number of columns, groups share them with either sign, so that neighbours still differ. `group` is -1
/// outside groups.
inline Columns indicators_of_groups(const std::vector<Index>& group, Index count) {
  constexpr Index most_columns = 16;
  Columns indicators = Columns::Zero(static_cast<Eigen::Index>(group.size()), std::min(count, most_columns));
  for (std::size_t v = 0; v < group.size(); ++v) {
    if (group[v] < 0) continue;
    for (Eigen::Index column = 0; column < indicators.cols(); ++column) {
      double& value = indicators(static_cast<Eigen::Index>(v), column);
      if (count <= most_columns) {
        value = group[v] == column ? 1 : 0;
      } else {
        std::uint64_t bits = (static_cast<std::uint64_t>(group[v]) << 8U) + static_cast<std::uint64_t>(column);
        bits = (bits ^ (bits >> 31U)) * 0x9E3779B97F4A7C15U;  // Fibonacci hashing
        value = (bits >> 63U) == 0 ? 1 : -1;
      }
    }
  }
  return indicators;
}

/// Returns Σ ∇w ∇wᵀ over the weights in a triangle, from its `hat_gradients` and its corners.
template <class Corners>
Eigen::Matrix3d slopes_of_weights(const Eigen::Matrix3d& hats, const Columns& weights, const Corners& corners) {
  Eigen::Matrix<double, 3, Eigen::Dynamic> values(3, weights.cols());
  for (int k = 0; k < 3; ++k) values.row(k) = weights.row(corners[k]);
  const Eigen::Matrix<double, 3, Eigen::Dynamic> gradients = hats.transpose() * values;
  return gradients * gradients.transpose();
}

/// Finds t √(certainty) in a triangle and the same across t, from its slopes and the steepest ones (the largest
/// trace) of its component.
inline void find_direction(const Eigen::Matrix3d& slopes, double steepest, const Eigen::Matrix3d& hats,
                           Eigen::Vector3d& along, Eigen::Vector3d& across) {
  if (!(steepest > 0)) return;
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> eigen(slopes);
  const double first = eigen.eigenvalues()[2], second = std::max(0.0, eigen.eigenvalues()[1]);
  const double certainty = std::max(0.0, first - second) / (first + second + flattest * steepest);
  along = std::sqrt(certainty) * eigen.eigenvectors().col(2);
  const Eigen::Vector3d normal = hats.row(0).cross(hats.row(1)).transpose();
  across = normal.stableNormalized().cross(along);
}

inline int corner_of(const Triangles& triangles, Index t, Index v) {
  return triangles(t, 0) == v ? 0 : triangles(t, 1) == v ? 1 : 2;
}

/// Returns the entries of Λ K in the row of a triangle's corner: slopes across t, as much as t is certain.
/// `free_area` is the area without given maps of the component, `area` that of the triangle.
inline Eigen::Vector3d stiffness_across(const Eigen::Vector3d& slopes, int corner, double free_area,
                                        double area) {
  return reach_of_means * free_area * area * slopes[corner] * slopes;
}

/// Returns the limb or disc at a point from t there (zero if unknown) and the means around it: those of
/// position (3) and of t tᵀ (6). Along a level line of a limb t points one way, which is the axis. Around a
/// disc it points in all directions of the plane that the axis stands on. Without `may_be_disc` there are limbs
/// only.
template <class Row>
LimbPoint limb_at(const Eigen::RowVector3d& point, const Eigen::RowVector3d& t, const Row& means,
                  bool may_be_disc) {
  LimbPoint at{Eigen::Vector3d::Zero(), Eigen::Vector3d::Zero(), Eigen::Vector3d::Zero()};
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> eigen(to_matrix(means.template tail<6>()));
  const double first = eigen.eigenvalues()[2], second = std::max(0.0, eigen.eigenvalues()[1]),
               third = std::max(0.0, eigen.eigenvalues()[0]);
  if (!(first > 1e-3)) return at;
  const Eigen::Vector3d offset = (point - means.template head<3>()).transpose();
  const double elongation = (first - second) / (first + second);
  if (elongation > least_elongation) {
    at.axis = at.direction = eigen.eigenvectors().col(2);
    at.moment = ramp(elongation, least_elongation, full_elongation) * at.axis.cross(offset);
    return at;
  }
  const double outward = offset.dot(t.transpose()) / std::max(offset.norm(), 1e-300);
  const double disc = share_of_disc(elongation, (second - third) / first, std::abs(outward));
  if (disc == 0 || !may_be_disc) return at;
  at.axis = eigen.eigenvectors().col(0);
  at.direction = outward < 0 ? Eigen::Vector3d(-t.transpose()) : Eigen::Vector3d(t.transpose());
  at.moment = disc * at.axis.cross(offset);
  return at;
}

/// The derivative of a field along t at a vertex, as it is averaged along level lines. On a limb t has no sign,
/// but the product with t does; on a disc t points away from the centre.
inline Eigen::RowVector4d averaged_derivative(const LimbPoint& at, const Eigen::RowVector3d& t,
                                              double derivative) {
  const double outward = !is_on_disc(at) ? 0 : at.direction.dot(t.transpose()) < 0 ? -1 : 1;
  return {derivative * t.x(), derivative * t.y(), derivative * t.z(), outward * derivative};
}

/// Returns the part of a mean (of `averaged_derivative`) along the direction in which rates are measured.
inline double along_direction(const LimbPoint& at, const Eigen::RowVector4d& mean) {
  return is_on_disc(at) ? mean[3] : mean.head<3>().dot(at.axis.transpose());
}
/// The same for a mean of t tᵀ.
inline double along_direction(const LimbPoint& at, const Tensor& mean) {
  return is_on_disc(at) ? mean.head<3>().sum() : at.axis.dot(to_matrix(mean) * at.axis);
}

/// Returns a matrix of zeros with an entry for each vertex and for each edge, in both directions.
inline SparseRows ring_matrix(const IndexLists& rings) {
  std::vector<int> lengths;
  for (Index v = 0; v < rings.size(); ++v) lengths.push_back(1 + static_cast<int>(rings[v].size()));
  SparseRows matrix = rows_of_lengths(lengths, rings.size());
  for (Index v = 0; v < rings.size(); ++v) {
    int* const columns = matrix.innerIndexPtr() + matrix.outerIndexPtr()[v];
    std::copy(rings[v].begin(), rings[v].end(), columns);
    columns[rings[v].size()] = v;
    std::sort(columns, columns + lengths[v]);
  }
  std::fill_n(matrix.valuePtr(), matrix.nonZeros(), 0.0);
  return matrix;
}

/// Returns the entry at an edge, or on the diagonal, of a `ring_matrix`.
inline double& matrix_entry(SparseRows& matrix, Index row, Index column) {
  const int* const begin = matrix.innerIndexPtr() + matrix.outerIndexPtr()[row];
  const int* const end = matrix.innerIndexPtr() + matrix.outerIndexPtr()[row + 1];
  return matrix.valuePtr()[std::lower_bound(begin, end, column) - matrix.innerIndexPtr()];
}

}  // namespace meshgraft
