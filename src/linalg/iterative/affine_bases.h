#pragma once

#include <cmath>
#include <cstddef>
#include <vector>

#include <Eigen/Core>
#include <Eigen/Eigenvalues>

namespace meshgraft {

/// Returns a basis of the affine functions of position for each of `count` aggregates of rows: its columns are
/// functions of (p, 1), namely principal axes about the centroid and a constant, each scaled to unit length
/// over the aggregate's rows. A column is zero where the aggregate is flat. `for_each_row` calls
/// body(aggregate, position) for each row.
template <class ForEachRow>
std::vector<Eigen::Matrix4d> affine_bases(std::size_t count, const ForEachRow& for_each_row) {
  constexpr double flat = 1e-10;  // axes with a smaller squared extent, relative to the largest, are flat
  std::vector<double> rows(count, 0.0);
  std::vector<Eigen::Vector3d> centre(count, Eigen::Vector3d::Zero());
  std::vector<Eigen::Matrix3d> moments(count, Eigen::Matrix3d::Zero());
  for_each_row([&](std::size_t a, const Eigen::Vector3d& p) {
    rows[a] += 1;
    centre[a] += p;
  });
  for (std::size_t a = 0; a < count; ++a) centre[a] /= rows[a];
  for_each_row([&](std::size_t a, const Eigen::Vector3d& p) {
    moments[a] += (p - centre[a]) * (p - centre[a]).transpose();
  });
  std::vector<Eigen::Matrix4d> bases(count, Eigen::Matrix4d::Zero());
  for (std::size_t a = 0; a < count; ++a) {
    const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> axes(moments[a]);
    const double largest = axes.eigenvalues()[2];
    for (int k = 0; k < 3; ++k) {
      const double extent = axes.eigenvalues()[k];
      if (!(extent > flat * largest)) continue;
      const Eigen::Vector3d axis = axes.eigenvectors().col(k) / std::sqrt(extent);
      bases[a].col(k) << axis, -axis.dot(centre[a]);
    }
    bases[a](3, 3) = 1 / std::sqrt(rows[a]);
  }
  return bases;
}

}  // namespace meshgraft
